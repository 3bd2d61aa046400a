"""Play between cylinder and link."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

SCANNED = tuple(0.15 * 0.8**step for step in range(28))
"""Shares of the travel: the squares have a local minimum for every contact that comes a little earlier or later, and a
fit reaches no farther than a tenth to either side (play of 0.047 rad at an arm's first joint)."""

STEP_SHARE = 0.5
"""With a play of 0.047 rad at an arm's first joint the rollout leaves 2.3 times the noise at 1 ms where the machine's
own numbers are known, 1.02 times at 0.5 ms (40 s of random voltage)."""

EFFECT = Effect(
    id="linkage.backlash",
    title="play in the linkage",
    equation="play of gap_rad in all between cylinder side and link; spring and damper where it is closed",
    parameters=(Parameter("gap_rad", "rad", "play, from contact to contact", neutral=0.0, lowest=0.0),),
    formula=Formula(
        r"\left| \theta_\mathrm{drive} - \theta_\mathrm{link} \right| \le \frac{g}{2}",
        {"gap_rad": "g"},
        {r"\theta_\mathrm{drive}, \theta_\mathrm{link}": "angles on both sides of the play"},
    ),
    inspect=(
        "Close the valves, rock the link by hand and watch a dial gauge: worn pins, bushings and mounts, "
        "rack or key with play."
    ),
    size="gap_rad",
    reads=("linkage.play_inertia", "linkage.play_stiffness", "linkage.play_damping"),
    search={
        "gap_rad": Search("travel", 0.25, SCANNED),
    },
    source="worn pins; contact model of Nordin and Gutman, Automatica 38 (2002) 1633",
    confused_with={
        "sensor.hysteresis": "play of the sensor leaves the pressures alone",
        "valve.spool_stiction": "a sticking spool also delays the start from rest",
    },
    sudden=True,
    step_share=STEP_SHARE,
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("linkage_gap")
@njit
def linkage_gap(joint: Any) -> float:
    """Play from contact to contact [rad]."""
    return joint.effects.linkage_backlash.gap_rad
