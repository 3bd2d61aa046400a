"""What an exported unit shows to the program that runs it: commands in, signals out, and where joints rest at first."""

from collections.abc import Sequence
from typing import NamedTuple

from hydrolek_drake.rigs import Rig

INPUT, OUTPUT, PARAMETER = "input", "output", "parameter"

UNITS: dict[str, dict[str, int]] = {
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "A": {"A": 1},
}
"""Unit -> exponents of the base units, which FMI asks for."""


class Variable(NamedTuple):
    """A variable of a unit.

    Attributes:
        name: of recordings where there is one, so that what a program records can be read.
        unit: one of `UNITS`.
        causality: `INPUT`, `OUTPUT` or `PARAMETER`.
        joint: whose it is.
        signal: name in `kernel.SIGNALS`; "" for what goes in.
        description: for people.
    """

    name: str
    unit: str
    causality: str
    joint: str
    signal: str
    description: str


def variables_of(rig: Rig, joints: Sequence[str]) -> list[Variable]:
    """Variables of some joints of a rig, in the order in which a unit lists them."""
    found = [each for joint in joints for each in _of_joint(rig, joint)]
    hydraulic = [joint for joint in joints if rig.is_hydraulic(joint)]
    if hydraulic:
        found.append(
            Variable(
                "supply.pressure", "Pa", OUTPUT, hydraulic[0], "supply_pressure", "pressure at the valves"
            )
        )
    return found


def _of_joint(rig: Rig, joint: str) -> list[Variable]:
    slides = rig.variant(joint, "load") == "sliding"
    position, place = ("m", "position") if slides else ("rad", "angle")
    rate, speed = ("m/s", "velocity") if slides else ("rad/s", "rate")
    found = [
        Variable(f"{joint}.command", "V", INPUT, joint, "", "command, held over a communication step"),
        Variable(
            f"{joint}.initial_{place}", position, PARAMETER, joint, "", "where it rests at first, in balance"
        ),
        Variable(f"{joint}.{place}", position, OUTPUT, joint, "reading", "what its sensor reads"),
        Variable(f"{joint}.true_{place}", position, OUTPUT, joint, "position", "where it is"),
        Variable(f"{joint}.{speed}", rate, OUTPUT, joint, "velocity", "how fast it moves"),
    ]
    if rig.tells_current(joint):
        found.append(
            Variable(
                f"{joint}.current", "A", OUTPUT, joint, "current", "of its motor, as the sensor reads it"
            )
        )
    if rig.is_hydraulic(joint):
        found += [
            Variable(f"{joint}.pressure_a", "Pa", OUTPUT, joint, "pressure_a", "pressure in chamber A"),
            Variable(f"{joint}.pressure_b", "Pa", OUTPUT, joint, "pressure_b", "pressure in chamber B"),
            Variable(f"{joint}.spool", "m", OUTPUT, joint, "spool", "position of the valve's spool"),
        ]
    return found
