"""Oil leaks past the piston or vane."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="cylinder.cross_port_leakage",
    title="leakage past the piston",
    equation="conductance (P_A - P_B) from A to B",
    parameters=(
        Parameter(
            "conductance_m3_per_s_Pa",
            "m^3/(s Pa)",
            "laminar conductance past the piston",
            neutral=0.0,
            lowest=0.0,
        ),
    ),
    formula=Formula(
        r"Q = G \left( p_A - p_B \right)",
        {"conductance_m3_per_s_Pa": "G"},
        {"Q": "oil flow from chamber A to B", "p_A, p_B": "pressures of the chambers"},
    ),
    inspect=(
        "Test the piston's or vane's seal: pressurise one side at the end stop, open the other port and "
        "measure the oil that comes out of it."
    ),
    size="conductance_m3_per_s_Pa",
    beneath="tightness",
    search={
        "conductance_m3_per_s_Pa": Search("conductance", 1, (0.02, 0.15)),
    },
    source="Merritt, Hydraulic Control Systems (1967), ch. 6: laminar leakage of pistons",
    confused_with={
        "valve.null_leakage": "leaking lands also let both pressures settle near half the supply",
        "supply.pressure_droop": "droop leaves the joint at rest alone",
    },
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("cross_conductance")
@njit
def cross_conductance(joint: Any) -> float:
    """Conductance from A to B [m^3/(s Pa)]."""
    return joint.effects.cylinder_cross_port_leakage.conductance_m3_per_s_Pa
