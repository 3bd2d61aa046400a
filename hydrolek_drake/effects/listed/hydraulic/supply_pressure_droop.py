"""The pump cannot hold its pressure when much flow is drawn."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="supply.pressure_droop",
    title="supply pressure falls with flow",
    equation="P_S - resistance Q, Q the flow drawn by all joints, low-passed",
    parameters=(
        Parameter("resistance_Pa_s_per_m3", "Pa s/m^3", "fall of pressure per flow", neutral=0.0, lowest=0.0),
    ),
    formula=Formula(
        "p = p_S - R Q",
        {"resistance_Pa_s_per_m3": "R"},
        {
            "p": "pressure at the valve",
            "p_S": "supply pressure without flow",
            "Q": "flow drawn by all joints",
        },
    ),
    inspect=(
        "Read the supply pressure at the valve while the joint moves fast: clogged filters, relief valve "
        "set low, pump or accumulator too small."
    ),
    size="resistance_Pa_s_per_m3",
    search={
        "resistance_Pa_s_per_m3": Search("resistance", 2, (0.05, 0.3)),
    },
    source="source impedance of pump and line; seen on the PATU crane (9.3 to 9.1 MPa while lifting)",
    confused_with={
        "cylinder.cross_port_leakage": "leakage slows the joint under load even at small flow",
        "amplifier.gain_fade": "fading depends on time, droop on flow",
    },
    needs={"supply": ("constant_pressure",), "cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("supply_drop")
@njit
def supply_drop(flow: float, joint: Any) -> float:
    """Fall of the supply pressure [Pa] at a flow [m^3/s]."""
    return joint.effects.supply_pressure_droop.resistance_Pa_s_per_m3 * flow
