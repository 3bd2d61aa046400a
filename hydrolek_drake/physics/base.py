"""The base on which the arm stands: rigid unless the effect base.compliance lets it rock."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter, Stage

STAGE = Stage(
    "base",
    "what the arm stands on",
    (Parameter("rocking_damping_ratio", "1", "damping ratio of a base that rocks", neutral=0.0, lowest=0.0),),
    {"rigid": ()},
)


@njit
def base_acceleration(tilt: float, rate: float, moment: float, joint: Any) -> tuple[float, float]:
    """Angular acceleration of a rocking base [rad/s^2] and its slope over the rate [1/s].

    J_b b'' = -moment - k b - 2 zeta sqrt(k J_b) b', where `moment` [N m] is what the actuator exerts on the
    link and so, reversed, on the base.
    """
    stiffness = hooks.base_stiffness(joint)
    inertia = hooks.base_inertia(joint)
    damping = 2.0 * joint.base.rocking_damping_ratio * math.sqrt(stiffness * inertia)
    return (-moment - stiffness * tilt - damping * rate) / inertia, -damping / inertia
