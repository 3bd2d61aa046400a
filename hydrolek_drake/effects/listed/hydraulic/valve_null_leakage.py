"""Oil leaks over the spool's lands."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="valve.null_leakage",
    title="leaking lands",
    equation="conductance times the pressure difference added to all four edge flows",
    parameters=(
        Parameter(
            "conductance_m3_per_s_Pa",
            "m^3/(s Pa)",
            "laminar conductance of one land",
            neutral=0.0,
            lowest=0.0,
        ),
    ),
    formula=Formula(
        r"Q = Q_\mathrm{orifice} + G \Delta p",
        {"conductance_m3_per_s_Pa": "G"},
        {"Q": "flow over each of the four edges", r"\Delta p": "pressure difference over it"},
    ),
    inspect=(
        "Block the valve's ports to the actuator, centre the spool and measure the oil that flows to the "
        "tank: worn lands leak."
    ),
    size="conductance_m3_per_s_Pa",
    beneath="tightness",
    search={
        "conductance_m3_per_s_Pa": Search("conductance", 1, (0.01, 0.06)),
    },
    source="Merritt, Hydraulic Control Systems (1967), ch. 5: laminar flow through the radial clearance of the lands",
    confused_with={
        "cylinder.cross_port_leakage": "a leaking piston lets the load sink; leaking lands also push both "
        "chambers to half the supply",
    },
    needs={"valve": ("plain", "pressure_compensated", "four_edges", "flow_map")},
)


@EFFECT.hook("edge_conductance")
@njit
def edge_conductance(joint: Any) -> float:
    """Conductance added to each edge [m^3/(s Pa)]."""
    return joint.effects.valve_null_leakage.conductance_m3_per_s_Pa
