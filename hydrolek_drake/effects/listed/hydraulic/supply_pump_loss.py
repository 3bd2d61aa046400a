"""The pump gives less than its displacement and speed say."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="supply.pump_loss",
    title="the pump gives too little",
    equation="the pump gives (1 - fraction) D w",
    parameters=(
        Parameter(
            "fraction", "1", "share of the pump's flow that is missing", neutral=0.0, lowest=0.0, highest=1.0
        ),
    ),
    formula=Formula(
        r"Q = (1 - f) D \omega",
        {"fraction": "f"},
        {"Q": "flow of the pump", "D": "its displacement", r"\omega": "its speed"},
    ),
    inspect=(
        "Measure the pump's delivery and case drain flow at working pressure; look for air at its suction "
        "and a drive that slips."
    ),
    size="fraction",
    search={"fraction": Search("unity", 0.95, (0.2, 0.6))},
    source="a worn or wrongly set pump, a motor that runs slowly: volumetric efficiency, Merritt, Hydraulic Control "
    "Systems (1967), section 4.2",
    confused_with={
        "supply.pressure_droop": "a source impedance lowers the pressure as much as is drawn, a pump that gives too "
        "little only beyond what it gives",
        "cylinder.cross_port_leakage": "a leaking piston slows the joint at small commands too",
    },
    needs={"supply": ("pump",)},
)


@EFFECT.hook("pump_loss")
@njit
def pump_loss(joint: Any) -> float:
    """Share of the pump's flow that is missing."""
    return joint.effects.supply_pump_loss.fraction
