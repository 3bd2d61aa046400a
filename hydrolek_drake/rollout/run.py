"""One machine and what it is driven with: a rollout that has not been made yet."""

from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.rollout.rollout import Outcome, roll_out


@dataclass(frozen=True)
class Run:
    """The arguments of `roll_out`, see there."""

    joint: np.ndarray
    command_times: np.ndarray
    command_values: np.ndarray
    times: np.ndarray
    longest_step: float
    spool_steps: int = 1
    state: np.ndarray | None = None
    probes: tuple[float, np.ndarray] | None = None
    pull: tuple[float, np.ndarray] | None = None
    law: np.ndarray | None = None

    def outcome(self) -> Outcome:
        """What the machine does, rolled out by itself.

        Raises:
            InputError: as of `roll_out`.
        """
        return roll_out(
            self.joint,
            self.command_times,
            self.command_values,
            self.times,
            state=self.state,
            longest_step=self.longest_step,
            spool_steps=self.spool_steps,
            probes=self.probes,
            pull=self.pull,
            law=self.law,
        )

    def of(self, joints: np.ndarray) -> "list[Run]":
        """The same with other parameter records, shape (n,)."""
        return [replace(self, joint=joints[i : i + 1]) for i in range(len(joints))]
