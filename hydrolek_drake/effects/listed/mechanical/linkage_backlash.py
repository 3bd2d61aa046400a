"""Play between cylinder and link."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="linkage.backlash",
    title="play in the linkage",
    equation="play of gap_rad in all between cylinder side and link; spring and damper where it is closed",
    parameters=(Parameter("gap_rad", "rad", "play, from contact to contact", neutral=0.0, lowest=0.0),),
    size="gap_rad",
    search={
        "gap_rad": Search("travel", 0.25, (0.15,)),
    },
    source="worn pins; contact model of Nordin and Gutman, Automatica 38 (2002) 1633",
    confused_with={
        "sensor.hysteresis": "play of the sensor leaves the pressures alone",
        "valve.spool_stiction": "a sticking spool also delays the start from rest",
    },
    sudden=True,
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("linkage_gap")
@njit
def linkage_gap(joint: Any) -> float:
    """Play from contact to contact [rad]."""
    return joint.effects.linkage_backlash.gap_rad
