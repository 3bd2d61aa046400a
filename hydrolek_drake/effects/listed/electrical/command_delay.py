"""More transport delay than modelled."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="command.delay",
    title="longer dead time",
    equation="T_d + delay_s",
    parameters=(Parameter("delay_s", "s", "added transport delay", neutral=0.0, arrival=True),),
    formula=Formula(
        r"u_\mathrm{arriving}(t) = u \left( t - T_d - \Delta T \right)",
        {"delay_s": r"\Delta T"},
        {"u": "command", "t": "time", "T_d": "delay that the rig has already"},
    ),
    inspect=(
        "Measure the time from a change of the command to the change of the coil current: network, "
        "controller's sample rate and filter, relays between them."
    ),
    size="delay_s",
    search={
        "delay_s": Search("travel_time", 0.5, (0.01, 0.05)),
    },
    source="thesis 6.1.3 (time delay of 0.15 s and 0.25 s, read by eye)",
    confused_with={
        "valve.spool_stiction": "stiction delays small commands more than large ones, a delay all alike",
    },
)


@EFFECT.hook("command_delay")
@njit
def command_delay(joint: Any) -> float:
    """Seconds added to the transport delay."""
    return joint.effects.command_delay.delay_s
