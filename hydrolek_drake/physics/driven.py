"""Recorded signals that drive the model in place of a part of it.

A chain can be cut wherever it is measured: with a recorded supply pressure, pump and line are left out; with a
recorded spool position all from the command to the spool; with recorded chamber pressures all from the command to
the oil. What was recorded comes by the input from outside (`probes`) of the part that it replaces, which acts on
nothing else then.
"""

from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.probes import AMPLIFIER, CAPACITY_A, CAPACITY_B, SUPPLY, Probe, added
from hydrolek_drake.physics.supply import supply_pressure
from hydrolek_drake.physics.usual import rare

DRIVEN = np.dtype(
    [("supply_pressure", np.float64), ("spool_position", np.float64), ("chamber_pressures", np.float64)]
)
"""Part of a joint's record: 1 where a recording drives the joint, else 0; `FOLLOWED` where a supply is followed."""

FOLLOWED = 2.0
"""Of a recorded supply pressure: it drives what lies behind the valves, and what is told is the supply's own, which the
flow acts on that the valves would draw at that one. The chain is cut so where it is measured, and both parts are held
against the measurement. A pump whose relief valve is closed would integrate what is drawn at another pressure."""

INPUTS: dict[str, tuple[int, ...]] = {
    "supply_pressure": (SUPPLY,),
    "spool_position": (AMPLIFIER,),
    "chamber_pressures": (CAPACITY_A, CAPACITY_B),
}
"""Places in `probes.PROBES` by which recorded values come [Pa, m, Pa]."""

UPSTREAM: dict[str, tuple[str, ...]] = {
    "supply_pressure": ("supply",),
    "spool_position": ("command", "amplifier", "solenoid"),
    "chamber_pressures": ("command", "amplifier", "solenoid", "valve", "supply", "fluid"),
}
"""Stages that count no longer where a signal drives the model."""

CHAMBERS_ONLY = ("dead_volume_a", "dead_volume_b", "initial_pressure_b")
"""Numbers of the cylinder that only its pressures depend on."""


def is_driven(joints: np.ndarray) -> bool:
    """Whether a recording drives any of some joints in place of a part of them."""
    numbers = joints.view(np.float64).reshape(len(joints), -1)  # this part of a record stands at its end
    return bool(numbers[:, -len(DRIVEN.names or ()) :].any())


@njit
def driven_by(recorded: Probe, outside: Probe) -> Probe:
    """Inputs of a joint from outside: what was recorded of it, and what others' laws add to the supply pressure."""
    return added(recorded, SUPPLY, outside.supply)


@njit
def pressure_at_valves(remembered: float, outside: Probe, probe: Probe, joint: Any) -> float:
    """Supply pressure [Pa]: as recorded, or the supply's with what is added to it.

    Args:
        remembered: see `supply.supply_pressure`.
        outside: inputs from outside.
        probe: the same with what a law adds.
        joint: parameter record.
    """
    if rare(joint) and joint.driven.supply_pressure > 0.0:
        return outside.supply if is_followed(joint) else probe.supply
    return supply_pressure(remembered, joint) + probe.supply


@njit
def is_followed(joint: Any) -> bool:
    """Whether the supply is followed beside its recorded pressure."""
    return rare(joint) and joint.driven.supply_pressure == FOLLOWED


@njit
def pressure_told(remembered: float, at_valves: float, outside: Probe, probe: Probe, joint: Any) -> float:
    """Supply pressure that is held against what was measured [Pa]: that at the valves, or of a supply that is followed.

    Args:
        remembered: see `supply.supply_pressure`.
        at_valves: see `pressure_at_valves` [Pa].
        outside: inputs from outside.
        probe: the same with what a law adds.
        joint: parameter record.
    """
    if is_followed(joint):
        return supply_pressure(remembered, joint) + probe.supply - outside.supply
    return at_valves


@njit
def chamber_pressures(p_a: float, p_b: float, probe: Probe, joint: Any) -> tuple[float, float]:
    """Pressures on sides A and B [Pa]: as recorded, or those of the model."""
    if rare(joint) and joint.driven.chamber_pressures > 0.0:
        return probe.capacity_a, probe.capacity_b
    return p_a, p_b


@njit
def spool_position(x: float, probe: Probe, joint: Any) -> float:
    """Position of the spool [m]: as recorded, or that of the model."""
    if rare(joint) and joint.driven.spool_position > 0.0:
        return probe.amplifier
    return x


@njit
def pressures_are_driven(joint: Any) -> bool:
    """Whether the chambers' pressures are recorded, so that the oil's compressibility is left out."""
    return rare(joint) and joint.driven.chamber_pressures > 0.0
