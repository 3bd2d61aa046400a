"""The spool's null is not where the amplifier thinks it is."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="valve.asymmetric_overlap",
    title="spool null shifted",
    equation="x - (overlap + shift) opens towards A, -x - (overlap - shift) towards B",
    parameters=(Parameter("shift_m", "m", "shift of the null towards B", neutral=0.0),),
    formula=Formula(
        r"x_A = x - (x_0 + \Delta), \quad x_B = -x - (x_0 - \Delta)",
        {"shift_m": r"\Delta"},
        {"x": "place of the spool", "x_0": "overlap", "x_A, x_B": "openings towards A and B"},
    ),
    inspect=(
        "Find the command at which the joint begins to move each way; then set the valve's null: centring "
        "springs, lock nut, zero of the amplifier."
    ),
    size="shift_m",
    beneath="ground",
    search={
        "shift_m": Search("overlap", 0.8, (0.1, -0.1), lowest=-0.8),
    },
    source="Merritt, Hydraulic Control Systems (1967), ch. 5: null shift of spool valves",
    confused_with={
        "valve.null_leakage": "leakage lets the joint creep at zero command",
        "load.payload": "a load acts on pressures at rest as well",
    },
    needs={"valve": ("plain", "pressure_compensated", "four_edges", "flow_map")},
)


@EFFECT.hook("land_shift")
@njit
def land_shift(joint: Any) -> float:
    """Metres by which the null is shifted."""
    return joint.effects.valve_asymmetric_overlap.shift_m
