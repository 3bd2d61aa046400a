"""A ball screw under a servo drive that follows a commanded position, and whose current is what it needs for that.

The cascade of such drives: a position controller gives a speed, a speed controller a current (EN 61800-7-201, profile
position and cyclic synchronous position mode; Gross, Hamann, Wiegaertner, Electrical Feed Drives in Automation (2001),
chapter 4). The current's own loop is faster than a step of the rest and counts as settled. A stepper whose position is
controlled is the same with a stiff speed controller, since its speed follows the steps.
"""

from typing import Any, NamedTuple

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.linkages.ball_screw import PARAMETERS as SCREW
from hydrolek_drake.physics.linkages.ball_screw import nut_force
from hydrolek_drake.physics.parameters import Parameter

_OWN = ("current_gain", "current_limit")
"""Parameters that a screw whose current is commanded has otherwise."""

PARAMETERS = (
    Parameter("set_point_gain", "m/V", "set point of the nut's position over command"),
    Parameter("set_point_neutral", "m", "set point at the neutral command", neutral=0.0),
    Parameter(
        "position_gain", "1/s", "speed over position error, K_v of the position controller", lowest=0.0
    ),
    Parameter(
        "position_time", "s", "integral time of the position controller; 0 for none", neutral=0.0, lowest=0.0
    ),
    Parameter("speed_limit", "m/s", "largest speed that it asks for; 0 for any", neutral=0.0, lowest=0.0),
    Parameter("speed_gain", "A s/m", "current over error of speed, of the speed controller", lowest=0.0),
    Parameter(
        "speed_time", "s", "integral time of the speed controller; 0 for none", neutral=0.0, lowest=0.0
    ),
    Parameter("current_limit", "A", "largest current of the drive", lowest=0.0, positive=True),
    *(parameter for parameter in SCREW if parameter.name not in _OWN),
)


class Controlled(NamedTuple):
    """What a drive does at one moment."""

    current: float  # of the motor [A]
    slope: float  # by how much speed lowers it [A s/m]
    lag_rate: float  # rate of the integral of the position's error [m]
    deficit_rate: float  # rate of the integral of the speed's error [m/s]


@njit
def controlled(
    command: float, position: float, velocity: float, lag: float, deficit: float, joint: Any
) -> Controlled:
    """Current of the drive and the rates of its integrals.

    v* = K_v (e + 1/T_v int e dt) within the speed limit, i = K_n (v* - v + 1/T_n int (v* - v) dt) within the current
    limit; an integral waits while its controller is at its limit and the error presses on (Astrom, Hagglund, PID
    Controllers (1995), section 3.5: conditional integration).

    Args:
        command: of the drive, away from neutral [V].
        position: of the nut [m].
        velocity: of the nut [m/s].
        lag: integral of the position's error [m s].
        deficit: integral of the speed's error [m].
        joint: parameter record.
    """
    p = joint.cylinder
    error = p.set_point_neutral + p.set_point_gain * command - position
    asked = error + (lag / p.position_time if p.position_time > 0.0 else 0.0)
    asked *= p.position_gain
    speed = asked
    if p.speed_limit > 0.0:
        speed = min(max(asked, -p.speed_limit), p.speed_limit)
    lag_rate = error if (asked - speed) * error <= 0.0 else 0.0
    slow = speed - velocity
    wanted = slow + (deficit / p.speed_time if p.speed_time > 0.0 else 0.0)
    wanted *= p.speed_gain
    current = min(max(wanted, -p.current_limit), p.current_limit)
    deficit_rate = slow if (wanted - current) * slow <= 0.0 else 0.0
    slope = p.speed_gain if wanted == current else 0.0
    return Controlled(current, slope, lag_rate, deficit_rate)


@njit
def driven(
    command: float, position: float, velocity: float, lag: float, deficit: float, joint: Any
) -> tuple[float, float, float, float]:
    """Force on the nut [N], by how much speed lowers it [N s/m], and the rates of the integrals; see `controlled`."""
    does = controlled(command, position, velocity, lag, deficit, joint)
    per_amp = nut_force(1.0, joint)
    return per_amp * does.current, per_amp * does.slope, does.lag_rate, does.deficit_rate


@njit
def at_rest(force: float, joint: Any) -> tuple[float, float]:
    """Integrals [m s, m] of a drive that has held a force on the nut [N] for a while, its error of position gone."""
    p = joint.cylinder
    per_speed = nut_force(p.speed_gain, joint)
    if not per_speed > 0.0:
        return 0.0, 0.0
    missing = force / per_speed
    if p.speed_time > 0.0:
        return 0.0, missing * p.speed_time
    if p.position_time > 0.0 and p.position_gain > 0.0:
        return missing * p.position_time / p.position_gain, 0.0
    return 0.0, 0.0
