"""One kind of concealed machine: its rig, its equations, how it is driven, and what it may conceal."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hydrolek_drake.challenge import arm_machine, arm_numbers, bench_machine, bench_numbers
from hydrolek_drake.challenge.driving import Driving, Played, arm_driving, bench_driving, unhindered
from hydrolek_drake.challenge.running import STEP_S, Player
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.yaml_files import package_yaml

BENCH = "joint_bench"
ARM_JOINTS = tuple(f"hydrolek_{side}_j{number}" for side in ("left", "right") for number in range(1, 6))
GROUPS: dict[str, tuple[str, ...]] = {
    "arms": ARM_JOINTS,
    "all": (BENCH, BENCH, *ARM_JOINTS),  # the bench as often as each joint, which is there on both sides
}
"""Choices of several rigs, drawn in turn."""


@dataclass(frozen=True)
class Build:
    """One rig's machines.

    Attributes:
        rig: whose numbers they share with the diagnosis.
        nominal: the machine that the rig describes, a `Machine` or an `ArmMachine`.
        spread: what differs from machine to machine -> its path in the rig.
        listed: effects that a machine may conceal -> size and draws, as in sizes.yaml.
        unlisted: physics in no list, likewise, and its stage.
        driving: commands and controller.
        run: runs them.
    """

    rig: Rig
    nominal: Any
    spread: Mapping[str, str]
    listed: Mapping[str, Any]
    unlisted: Mapping[str, Any]
    driving: Driving
    run: Player

    @property
    def noise(self) -> float:
        """Standard deviation of the reading's noise [rad]."""
        return self.rig.value("sensor.noise")

    def play(
        self,
        machine: Any,
        command: np.ndarray | None,
        set_points: np.ndarray | None = None,
        noise: np.ndarray | None = None,
        step: float = STEP_S,
    ) -> Played:
        """Run a machine; see `running.Player`."""
        return self.run(machine, self.driving, command, set_points, noise, step)

    def replay(self, machine: Any, volts: np.ndarray, step: float = STEP_S) -> Played:
        """Apply voltages to a machine that were applied to another one."""
        return self.run(machine, unhindered(self.driving), volts, None, None, step)


def rig_names(choice: str) -> tuple[str, ...]:
    """Rigs of a choice: one rig's name, or a group's.

    Raises:
        InputError: neither.
    """
    if choice in (BENCH, *ARM_JOINTS):
        return (choice,)
    if choice not in GROUPS:
        raise InputError(
            f"--rig {choice}: no concealed machines of it; choose {', '.join((BENCH, *ARM_JOINTS, *GROUPS))}"
        )
    return GROUPS[choice]


def build_of(rig: Rig) -> Build:
    """Machines of one of `BENCH` and `ARM_JOINTS`."""
    sizes = package_yaml(__package__, "sizes.yaml")
    if rig.name == BENCH:
        return Build(
            rig,
            bench_numbers.nominal_machine(rig),
            bench_numbers.SPREAD,
            sizes["listed"],
            sizes["unlisted"],
            bench_driving(),
            bench_machine.play,
        )
    arm = sizes["arm"]
    own = {**arm["listed"], **arm["joints"][rig.name.rpartition("_")[2]]}
    listed = {
        name: {**sizes["listed"].get(name, {}), **own.get(name, {})}
        for name in (*sizes["listed"], *arm["listed"])
        if name not in arm["leaves_out"]
    }
    return Build(
        rig,
        arm_numbers.nominal_machine(rig),
        arm_numbers.SPREAD,
        listed,
        {name: {**entry, **own.get(name, {})} for name, entry in sizes["unlisted"].items()},
        arm_driving(rig),
        arm_machine.play,
    )
