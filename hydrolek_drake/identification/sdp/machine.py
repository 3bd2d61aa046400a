"""The simulated machine on which step tests and validation runs are made: one joint of a rig."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.sdp.step_test import StepTest, campaign_data
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.rollout import roll_out


@dataclass(frozen=True)
class Machine:
    """A joint's full hydraulic model, with the noise of its potentiometer.

    Attributes:
        rig: the machine.
        joint: which moves; the others stand.
    """

    rig: Rig
    joint: str

    def __post_init__(self) -> None:
        if self.joint not in self.rig.joints:
            raise InputError(
                f"rig {self.rig.name} has no joint '{self.joint}'; choose {', '.join(self.rig.joints)}"
            )
        if self.rig.variant(self.joint, "load") == "sliding":
            raise InputError(
                f"rig {self.rig.name}: {self.joint} slides; step tests here are of turning joints"
            )

    @property
    def range_deg(self) -> tuple[float, float]:
        """The joint's stops."""
        load = f"joints.{self.joint}.load"
        low, high = (np.degrees(self.rig.value(f"{load}.{name}")) for name in ("lower_stop", "upper_stop"))
        return float(low), float(high)

    def angle(
        self, voltage_V: np.ndarray, sample: float, start_deg: float, rng: np.random.Generator
    ) -> np.ndarray:
        """Reading under a voltage that is held over each sample [deg]. # (n,) -> (n,).

        Raises:
            InputError: the simulation diverges.
        """
        index = self.rig.joints.index(self.joint)
        record = self.rig.records()[index : index + 1]
        time = np.arange(len(voltage_V)) * sample
        outcome = roll_out(
            record,
            time,
            voltage_V,
            time,
            state=rest_state(record, float(np.radians(start_deg))),
            longest_step=self.rig.value("integration.longest_step"),
            spool_steps=int(self.rig.value("integration.spool_steps")),
        )
        if outcome.diverged:
            raise InputError(f"rig {self.rig.name}, {self.joint}: the step test {outcome.diverged}")
        noise = self.rig.value(f"joints.{self.joint}.sensor.noise")
        return np.degrees(outcome.signals.reading + noise * rng.standard_normal(len(time)))

    def campaign(self, rng: np.random.Generator, moving: bool = False, fine: bool = False) -> list[StepTest]:
        """The step tests of section 6.1.1.

        Args:
            rng: draws the noise.
            moving: also those in which the joint moves before the step; the thesis recorded but did not use
                them.
            fine: also levels of tenths of a volt near the dead-zone, without which the curve of a steep law
                is not seen.
        """
        plan = campaign_data()
        sample = float(plan["sample"]["value"])
        levels = sorted(map(float, [*plan["levels_V"], *(plan["levels_fine_V"] if fine else ())]))
        tests = []
        for before in (0.0, *(map(float, plan["levels_before_V"]) if moving else ())):
            lead = plan["moving_before" if before else "rest"]["value"]
            for level in levels:
                if level == before:
                    continue
                step = round(float(lead) / sample)
                voltage = np.full(step + round(float(plan["duration"]["value"]) / sample), level)
                voltage[:step] = before
                reading = self.angle(voltage, sample, self._start(before, level), rng)
                tests.append(StepTest(sample, voltage, reading, step))
        return tests

    def _start(self, before: float, level: float) -> float:
        """Where a test begins: near the end that it leaves, in the middle if it turns round."""
        low, high = self.range_deg
        if before * level < 0.0:
            return 0.5 * (low + high)
        from_end = float(campaign_data()["from_end"]["value"])
        return low + from_end if level > 0.0 else high - from_end
