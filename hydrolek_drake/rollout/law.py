"""A short law as feedback: one input from outside (`probes`) as a function of time and of the joint's own state.

value = (a sin 2 pi f t + b cos 2 pi f t, or a where f = 0) * time * place * speed * other

with one factor out of each of the lists below. The law is evaluated within the rollout: a friction that was given
as a course in time could not hold a joint that sticks.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.rollout.probes import PROBES, Probe, added

TIMES = ("1", "t/T", "(t/T)^2")
PLACES = ("1", "z", "z^2", "(1 - z^2)", "((1 + z)/2)^2", "((1 - z)/2)^2")
SPEEDS = ("1", "sign(v)", "v", "|v|", "v |v|")
OTHERS = ("1", "p_A", "p_B", "(p_A - p_B)", "x", "|x|")
"""t: time since switching on, T: `seconds`, z: position from -1 at `low` to 1 at `high`, v: speed over `speed`, for a
force at the rod positive where the rod extends, sign(v): tanh(v over `slow`), p: pressure over `pressure`, x: spool
over `opening`."""

LAW = np.dtype(
    [
        (name, np.float64)
        for name in (
            "probe", "time", "place", "speed_shape", "other",  # what, and which factors, as places in their lists
            "sine", "cosine", "frequency",  # a, b (SI unit of the probe), f [Hz]
            "seconds", "low", "high", "speed", "slow", "direction", "opening", "pressure",
        )
    ]
)  # fmt: skip
"""Speeds and positions in those of the joint [rad or m]; direction: 1 if the rod extends where the joint's position
rises, else -1."""

_CYLINDER = float(PROBES.index("cylinder"))
_LOAD = float(PROBES.index("load"))


@njit
def time_factor(shape: float, t: float) -> float:
    """A factor of `TIMES`."""
    if shape == 1.0:
        return t
    return t * t if shape == 2.0 else 1.0


@njit
def place_factor(shape: float, z: float) -> float:
    """A factor of `PLACES`."""
    if shape == 1.0:
        return z
    if shape == 2.0:
        return z * z
    if shape == 3.0:
        return 1.0 - z * z
    if shape == 4.0:
        return (0.5 * (1.0 + z)) ** 2
    return (0.5 * (1.0 - z)) ** 2 if shape == 5.0 else 1.0


@njit
def speed_factor(shape: float, v: float, sign: float) -> float:
    """A factor of `SPEEDS`."""
    if shape == 1.0:
        return sign
    if shape == 2.0:
        return v
    if shape == 3.0:
        return abs(v)
    return v * abs(v) if shape == 4.0 else 1.0


@njit
def other_factor(shape: float, p_a: float, p_b: float, x: float) -> float:
    """A factor of `OTHERS`."""
    if shape == 1.0:
        return p_a
    if shape == 2.0:
        return p_b
    if shape == 3.0:
        return p_a - p_b
    if shape == 4.0:
        return x
    return abs(x) if shape == 5.0 else 1.0


@njit
def _without_speed(law: Any, time: float, q: float, p_a: float, p_b: float, x: float) -> float:
    """A law's value but for its factor of the speed."""
    size = law.sine
    if law.frequency > 0.0:
        angle = 2.0 * math.pi * law.frequency * time
        size = law.sine * math.sin(angle) + law.cosine * math.cos(angle)
    z = 2.0 * (q - law.low) / (law.high - law.low) - 1.0
    return (
        size
        * time_factor(law.time, time / law.seconds)
        * place_factor(law.place, z)
        * other_factor(law.other, p_a / law.pressure, p_b / law.pressure, x / law.opening)
    )


@njit
def law_value(law: Any, time: float, q: float, w: float, p_a: float, p_b: float, x: float) -> float:
    """A law's value.

    Args:
        law: a record of `LAW`.
        time: since switching on [s].
        q: position of the joint [rad or m].
        w: its speed.
        p_a: pressure on side A [Pa].
        p_b: pressure on side B [Pa].
        x: of the spool [m].
    """
    turned = w * law.direction if law.probe == _CYLINDER else w
    speed = speed_factor(law.speed_shape, turned / law.speed, math.tanh(turned / law.slow))
    return _without_speed(law, time, q, p_a, p_b, x) * speed


@njit
def felt(
    probe: Probe, laws: np.ndarray | None, time: float, q: float, w: float, p_a: float, p_b: float, x: float
) -> Probe:
    """Probes with what a law adds, if there is one; arguments as of `law_value`."""
    if laws is None:  # known when this is compiled: the rollout without a law is a program of its own
        return probe
    law = laws[0]
    return added(probe, law.probe, law_value(law, time, q, w, p_a, p_b, x))


@njit
def braking_slope(
    laws: np.ndarray | None, lever: float, time: float, q: float, w: float, p_a: float, p_b: float, x: float
) -> float:
    """Secant slope of a law's moment over the joint's speed where it brakes, else 0 [N m s/rad].

    What a stiff integrator must know of a friction; arguments as of `law_value`, and the rod's lever.
    """
    if laws is None:
        return 0.0
    law = laws[0]
    if (law.probe != _CYLINDER and law.probe != _LOAD) or law.speed_shape == 0.0 or law.speed_shape == 3.0:
        return 0.0
    secant = 1.0 / law.speed
    if law.speed_shape == 1.0:
        ratio = w / law.slow
        secant = math.tanh(ratio) / w if abs(ratio) > 1e-6 else 1.0 / law.slow
    elif law.speed_shape == 4.0:
        secant = abs(w) / law.speed**2
    arm = lever * law.direction if law.probe == _CYLINDER else 1.0
    return min(_without_speed(law, time, q, p_a, p_b, x) * secant * arm, 0.0)
