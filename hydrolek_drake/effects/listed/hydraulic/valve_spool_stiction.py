"""Coulomb friction on the spool: hysteresis of the opening against the current."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.smooth import hyperbolic_tangent

EFFECT = Effect(
    id="valve.spool_stiction",
    title="spool sticks",
    equation="force tanh(x'/stiction_velocity) against the spool",
    parameters=(Parameter("force_N", "N", "Coulomb friction of the spool", neutral=0.0, lowest=0.0),),
    formula=Formula(
        r"F = F_s \tanh \left( \frac{\dot x}{v_0} \right)",
        {"force_N": "F_s"},
        {
            "F": "force against the spool",
            r"\dot x": "speed of the spool",
            "v_0": "stiction velocity of the rig",
        },
    ),
    inspect=(
        "Look for dirt or varnish in the valve: cleanliness of the oil, filter, whether the spool slides "
        "freely by hand, whether the amplifier's dither is on."
    ),
    size="force_N",
    search={
        "force_N": Search("spool_force", 0.4, (0.02, 0.1)),
    },
    source="Merritt, Hydraulic Control Systems (1967), ch. 5; smoothed as in the solenoid's stiction_velocity",
    confused_with={
        "command.delay": "a delay is the same for large and small commands",
        "linkage.backlash": "play shows in the angle at reversals of the load, stiction at reversals of the command",
    },
    needs={"solenoid": ("spool_pair",)},
)


@EFFECT.hook("spool_friction")
@njit
def spool_friction(velocity: float, joint: Any) -> tuple[float, float]:
    """Friction [N] and its secant slope [N s/m] at a spool velocity [m/s].

    The secant, not the tangent: it still damps a fast spool that the friction is about to stop. With the
    tangent, which is flat there, a step overshoots the stop and the spool sticks at the wrong place.
    """
    force = joint.effects.valve_spool_stiction.force_N
    if force == 0.0:
        return 0.0, 0.0
    smooth = joint.solenoid.stiction_velocity
    share = hyperbolic_tangent(velocity / smooth)
    if abs(share) < 1e-3:  # the secant's limit, equal to 3e-7
        return force * share, force / smooth
    return force * share, force * share / velocity
