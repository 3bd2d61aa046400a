"""Solenoids and the spool between them, equations (4.5), (4.6); and a servo valve's spool.

The spool depends on the command, and on pressures only as far as flow forces go, so it is advanced on its own:
`advance` is the one-step method that both executions use.
"""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.usual import rare
from hydrolek_drake.physics.valves import switching
from hydrolek_drake.physics.valves.openings import openings

STAGE = Stage(
    "solenoid",
    "coil current to spool position",
    (),
    {
        "spool_pair": (
            Parameter(
                "force_constant_a",
                "N/A^2",
                "force of solenoid A over squared current, alpha/beta^2 in (4.5)",
                lowest=0.0,
            ),
            Parameter(
                "force_constant_b",
                "N/A^2",
                "force of solenoid B over squared current, alpha/beta^2 in (4.5)",
                lowest=0.0,
            ),
            Parameter(
                "gap_constant", "1/m", "how the air gap lowers the force, gamma/beta in (4.5)", lowest=0.0
            ),
            Parameter("moving_mass", "kg", "plunger and spool, m_p in (4.5)", lowest=0.0, positive=True),
            Parameter("damping", "N s/m", "lambda_p in (4.5)", lowest=0.0),
            Parameter("spring", "N/m", "K_p in (4.5)", lowest=0.0),
            Parameter(
                "stiction_velocity",
                "m/s",
                "below this the spool's Coulomb friction is smoothed",
                lowest=0.0,
                positive=True,
            ),
        ),
        "servo_valve": (
            Parameter("rated_voltage", "V", "voltage of full spool stroke", lowest=0.0, positive=True),
            Parameter("full_stroke", "m", "spool stroke at rated voltage", lowest=0.0),
            Parameter("bandwidth", "rad/s", "natural frequency of the spool's position loop", lowest=0.0),
            Parameter("damping_ratio", "1", "damping ratio of the spool's position loop", lowest=0.0),
            Parameter("slew_rate", "m/s", "highest speed of the spool; 0 for any", neutral=0.0, lowest=0.0),
        ),
        "none": (),
        "switching": switching.PARAMETERS,
    },
)
SPOOL_PAIR = float(STAGE.code("spool_pair"))
SERVO_VALVE = float(STAGE.code("servo_valve"))
NO_SPOOL = float(STAGE.code("none"))
SWITCHING = float(STAGE.code("switching"))

# Two-stage Rosenbrock-W method of Verwer, Spee, Blom, Hundsdorfer, SIAM J. Sci. Comput. 20 (1999) 1456:
# of second order whatever matrix is used, L-stable with this constant.
GAMMA = 1.0 - math.sqrt(0.5)

# A spool that sticks and breaks away needs finer steps than a smooth one: with this many, steps of 0.5 ms stay
# within 0.02 deg up to a friction of twice the force at the overlap (tests/rollout/test_bench_recordings.py).
STEPS_WHERE_STICKING = 4


@njit
def solenoid_force(current: float, stroke: float, constant: float, gap_constant: float) -> float:
    """Force of one solenoid [N] at its current [A] and its plunger's stroke [m], equation (4.5)."""
    gap = 1.0 + gap_constant * max(stroke, 0.0)
    return constant * current * current / (gap * gap)


@njit
def spool_acceleration(
    x: float,
    v: float,
    drive_a: float,
    drive_b: float,
    joint: Any,
    closing_a: float = 0.0,
    closing_b: float = 0.0,
) -> tuple[float, float]:
    """Acceleration of the spool [m/s^2] and its slope over velocity [1/s], equations (4.5), (4.6).

    Args:
        x: spool position, positive opens P to A (4.6) [m].
        v: spool velocity [m/s].
        drive_a: what drives towards A: coil current [A], or voltage [V] of a servo valve.
        drive_b: what drives towards B.
        joint: parameter record.
        closing_a: flow force where it is wholly open towards A, `valve.flow_forces` [N]; a servo valve's position loop
            makes up for it.
        closing_b: where it is towards B [N].
    """
    p = joint.solenoid
    if p.variant == SERVO_VALVE:
        target = min(max((drive_a - drive_b) / p.rated_voltage, -1.0), 1.0) * p.full_stroke
        damping = 2.0 * p.damping_ratio * p.bandwidth
        return p.bandwidth * p.bandwidth * (target - x) - damping * v, -damping
    friction, friction_slope = hooks.spool_friction(v, joint)
    force = (
        solenoid_force(drive_a, x, p.force_constant_a, p.gap_constant)
        - solenoid_force(drive_b, -x, p.force_constant_b, p.gap_constant)
        - p.damping * v
        - p.spring * x
        - friction
    )
    if closing_a > 0.0 or closing_b > 0.0:
        opened = openings(x, joint)
        force -= closing_a * opened.pa - closing_b * opened.pb
    per_mass = 1.0 / p.moving_mass
    return force * per_mass, -(p.damping + friction_slope) * per_mass


@njit
def advance(
    x: float,
    v: float,
    drive_a: float,
    drive_b: float,
    h: float,
    steps: int,
    joint: Any,
    closing_a: float = 0.0,
    closing_b: float = 0.0,
) -> tuple[float, float]:
    """Spool position and velocity after `h` seconds of a held drive and flow force, in `steps` Rosenbrock-W steps.

    A spool with dry friction takes `STEPS_WHERE_STICKING` as many.
    """
    return advanced(x, v, drive_a, drive_b, h, steps_needed(steps, joint), joint, closing_a, closing_b)


@njit
def steps_needed(steps: int, joint: Any) -> int:
    """Steps of a spool, where one without dry friction takes `steps`."""
    _, sticking = hooks.spool_friction(0.0, joint)
    return steps * STEPS_WHERE_STICKING if sticking > 0.0 else steps


@njit
def advanced(
    x: float,
    v: float,
    drive_a: float,
    drive_b: float,
    h: float,
    steps: int,
    joint: Any,
    closing_a: float,
    closing_b: float,
) -> tuple[float, float]:
    """The same as `advance`, in exactly so many steps."""
    if joint.solenoid.variant == NO_SPOOL:
        return 0.0, 0.0
    if rare(joint) and joint.solenoid.variant == SWITCHING:
        return switching.switched(x, drive_a - drive_b, h, joint)
    dt = h / steps
    if steps == 2:  # written out, as below: within a loop over lanes no other may stand
        return _two_steps(x, v, drive_a, drive_b, dt, joint, closing_a, closing_b)
    if steps in (4, 8):
        x, v = _two_steps(x, v, drive_a, drive_b, dt, joint, closing_a, closing_b)
        x, v = _two_steps(x, v, drive_a, drive_b, dt, joint, closing_a, closing_b)
        if steps == 8:
            x, v = _two_steps(x, v, drive_a, drive_b, dt, joint, closing_a, closing_b)
            x, v = _two_steps(x, v, drive_a, drive_b, dt, joint, closing_a, closing_b)
        return x, v
    for _ in range(steps):
        x, v = _step(x, v, drive_a, drive_b, dt, joint, closing_a, closing_b)
    return x, v


@njit
def _two_steps(
    x: float,
    v: float,
    drive_a: float,
    drive_b: float,
    dt: float,
    joint: Any,
    closing_a: float,
    closing_b: float,
) -> tuple[float, float]:
    """Two of them."""
    x, v = _step(x, v, drive_a, drive_b, dt, joint, closing_a, closing_b)
    return _step(x, v, drive_a, drive_b, dt, joint, closing_a, closing_b)


@njit
def _step(
    x: float,
    v: float,
    drive_a: float,
    drive_b: float,
    dt: float,
    joint: Any,
    closing_a: float,
    closing_b: float,
) -> tuple[float, float]:
    """One Rosenbrock-W step of the spool."""
    if rare(joint) and joint.solenoid.variant == SERVO_VALVE and joint.solenoid.slew_rate > 0.0:
        return _slewing(x, v, drive_a, drive_b, dt, joint)
    acceleration, slope = spool_acceleration(x, v, drive_a, drive_b, joint, closing_a, closing_b)
    scale = 1.0 / (1.0 - GAMMA * dt * slope)
    x1, v1 = v, acceleration * scale
    acceleration, _ = spool_acceleration(
        x + dt * x1, v + dt * v1, drive_a, drive_b, joint, closing_a, closing_b
    )
    x2, v2 = v + dt * v1 - 2.0 * x1, (acceleration - 2.0 * v1) * scale
    return x + dt * (1.5 * x1 + 0.5 * x2), v + dt * (1.5 * v1 + 0.5 * v2)


@njit
def _slewing(
    x: float, v: float, drive_a: float, drive_b: float, dt: float, joint: Any
) -> tuple[float, float]:
    """One step of a servo valve's spool whose speed is limited, by what its first stage gives or drives.

    Below the limit it is the position loop of `spool_acceleration`; at the limit the speed stays until the loop brakes
    (Merritt, Hydraulic Control Systems, 1967, section 7.4: a first stage's flow is limited). The loop is solved in two
    stages as by `_step`, and the speed cut after each.
    """
    most = joint.solenoid.slew_rate
    v = min(max(v, -most), most)
    acceleration, slope = spool_acceleration(x, v, drive_a, drive_b, joint)
    scale = 1.0 / (1.0 - GAMMA * dt * slope)
    x1, v1 = v, acceleration * scale
    ahead = min(max(v + dt * v1, -most), most)
    v1 = (ahead - v) / dt
    acceleration, _ = spool_acceleration(x + dt * x1, ahead, drive_a, drive_b, joint)
    x2, v2 = ahead - 2.0 * x1, (acceleration - 2.0 * v1) * scale
    reached = min(max(v + dt * (1.5 * v1 + 0.5 * v2), -most), most)
    return x + dt * (1.5 * x1 + 0.5 * x2), reached
