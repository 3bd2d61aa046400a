"""The valve's ports choke what its edges let through."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="valve.port_restriction",
    title="flow saturates: the ports choke it",
    equation="share s of full opening lets through as much as s / sqrt(1 + ratio s^2) without the ports",
    parameters=(
        Parameter(
            "ratio",
            "1",
            "pressure drop in the ports over that across the edge when fully open",
            neutral=0.0,
            lowest=0.0,
        ),
    ),
    formula=Formula(
        r"s_\mathrm{eff} = \frac{s}{\sqrt{1 + r s^2}}", {"ratio": "r"}, {"s": "share of the full opening"}
    ),
    inspect=(
        "Measure the pressure drop at full flow and look for what is narrow: kinked hose, small fitting, "
        "throttle or check valve left in."
    ),
    size="ratio",
    search={
        "ratio": Search("unity", 4, (0.3, 1.5)),
    },
    # a proportional valve's full openings are fitted, and its coils' currents end where they end
    searched_on={"solenoid": ("servo_valve",)},
    source="two orifices in series; SAE ARP490 and ISO 10770-1: flow saturation region of servo valves",
    confused_with={
        "supply.pressure_droop": "a drooping supply falls with all that is drawn, and slows the joint less in the "
        "direction that draws less; the ports choke both alike, by the opening",
    },
    needs={"valve": ("plain", "four_edges")},
)


@EFFECT.hook("port_drop")
@njit
def port_drop(joint: Any) -> float:
    """Pressure drop in the ports over that across the edge when fully open."""
    return joint.effects.valve_port_restriction.ratio
