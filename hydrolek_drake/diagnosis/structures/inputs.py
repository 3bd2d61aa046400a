"""Unknown inputs of a joint: where physics that is in no list may enter, and as what."""

import math
from dataclasses import dataclass

from hydrolek_drake.effects.scales import GROUND, Scales
from hydrolek_drake.physics.probes import PROBES


@dataclass(frozen=True)
class Input:
    """One unknown input.

    Attributes:
        stage: where it enters.
        probe: as what; one of `probes.PROBES`.
        symbol: how a law names it.
        unit: SI unit, "1" for a relative change.
        scale: a large amplitude for this machine.
        one_sided: whether it is a constant of the machine that cannot be less than none: a time that something takes,
            or a share.
        beneath: an amplitude that makes no difference in practice, as for the effect that does the same
            (`effects.scales`); 0 where none is known.
    """

    stage: str
    probe: str
    symbol: str
    unit: str
    scale: float
    one_sided: bool = False
    beneath: float = 0.0


SIDES = ("cylinder", "load")
"""Inputs that are forces: at the rod and, on the other side of the linkage, at the joint."""


def inputs_of(scales: Scales, pressure: float, limit: float, position_unit: str) -> tuple[Input, ...]:
    """The unknown inputs of a joint; those of the hydraulics are left out where there are none (NaN scales).

    Args:
        scales: natural scales of the joint.
        pressure: of the supply [Pa].
        limit: largest command [V].
        position_unit: rad or m.
    """
    moment = "N m" if position_unit == "rad" else "N"
    ground = 0.0 if math.isnan(scales.opening) else GROUND  # of the spool's opening, and so of what drives it
    inputs = [
        Input("command", "command", "voltage added to the command", "V", 0.3 * limit, beneath=ground * limit),
        Input("load", "load", "moment added at the joint" if moment == "N m" else "force added at the load", moment,
              0.3 * scales.load_force, beneath=scales.load_rubbing),
        Input("sensor", "sensor", "added to the reading", position_unit, 0.1 * scales.travel, beneath=scales.bit),
        Input("command", "ramp", "time that a ramp of the voltage takes for each volt", "s/V",
              0.3 * scales.travel_time / limit, one_sided=True),
    ]  # fmt: skip
    if math.isfinite(scales.conductance):
        inputs += [
            Input("supply", "supply", "added to the supply pressure", "Pa", 0.3 * pressure),
            Input("amplifier", "amplifier", "relative change of the coil currents", "1", 0.3, beneath=ground),
            Input("valve", "valve", "relative change of the valve's opening", "1", 0.6, beneath=ground),
            Input(
                "valve",
                "back_a",
                "relative change of what flows from side A to the tank",
                "1",
                0.6,
                beneath=ground,
            ),
            Input(
                "valve",
                "back_b",
                "relative change of what flows from side B to the tank",
                "1",
                0.6,
                beneath=ground,
            ),
            Input(
                "amplifier",
                "coil_time",
                "time constant of the coils' currents, added",
                "s",
                0.3 * scales.travel_time,
                one_sided=True,
            ),
            Input(
                "valve",
                "flow_force",
                "force of the oil that closes the spool, as a share of opening area times pressure drop, added",
                "1",
                0.3,
                one_sided=True,
            ),
            Input(
                "cylinder",
                "cylinder",
                "force added at the rod",
                "N",
                0.3 * scales.force,
                beneath=scales.rubbing,
            ),
            Input(
                "fluid", "capacity_a", "volume taken per pressure on side A, added", "m^3/Pa", scales.capacity
            ),
            Input(
                "fluid", "capacity_b", "volume taken per pressure on side B, added", "m^3/Pa", scales.capacity
            ),
        ]
    return tuple(sorted(inputs, key=lambda i: PROBES.index(i.probe)))
