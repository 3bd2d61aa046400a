"""A short law as feedback: inputs from outside (`probes`) as functions of time and of the joint's own state.

value = sum of (a sin 2 pi f t + b cos 2 pi f t, or a where f = 0) * time * place * speed * other

with one factor out of each of the lists below in every term. Place and speed are those of the stage: of the rod where
the term acts in the hydraulics, else of the joint. The law is evaluated within the rollout: a friction that was given
as a course in time could not hold a joint that sticks.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from hydrolek_drake.physics.probes import CYLINDER, LOAD, Probe, added

TIMES = ("1", "t/T", "(t/T)^2")
NEAR = "near"
"""At one place of the movement alone: half a wave of cosine squared around `centre`, nothing beyond `reach` from it
(a Hann window; several half their width apart add up to 1 between them)."""

PLACES = ("1", "z", "z^2", "(1 - z^2)", "((1 + z)/2)^2", "((1 - z)/2)^2", NEAR)
SPEEDS = ("1", "sign(v)", "v", "|v|", "v |v|")
OTHERS = ("1", "p_A", "p_B", "(p_A - p_B)", "x", "|x|")
"""t: time since switching on, T: `seconds`, z: stroke or position, -1 at `low` and 1 at `high`; near:
cos(pi/2 d)^2 with d the distance from `centre` over `reach`, and 0 beyond 1; v: speed over `speed`, sign(v): tanh(v
over `slow`), p: pressure over `pressure`, x: spool over `opening`."""

LAW = np.dtype(
    [
        (name, np.float64)
        for name in (
            "probe", "time", "place", "speed_shape", "other",  # what, and which factors, as places in their lists
            "sine", "cosine", "frequency",  # a, b (SI unit of the probe), f [Hz]
            "at_rod",  # 1 where place and speed are the rod's, 0 where they are the joint's
            "seconds", "low", "high", "centre", "reach", "speed", "slow", "opening", "pressure",
        )
    ]
)  # fmt: skip
"""One row for each term."""

MOST_TERMS = 6
"""So many terms a rig may hold for a joint."""

TERM_NAMES = tuple(f"term_{number}" for number in range(1, MOST_TERMS + 1))
LAW_RECORD = np.dtype([(name, LAW) for name in TERM_NAMES])
"""The law of a joint in its record; a term without amplitude is none."""


class Seen(NamedTuple):
    """What a law may depend on, at one moment."""

    time: float  # since switching on [s]
    q: float  # position of the joint [rad or m]
    w: float  # its speed
    stroke: float  # of the rod [m, of a vane rad]; 0 in a machine without oil
    v: float  # its speed, positive where it extends
    p_a: float  # pressure on side A [Pa]
    p_b: float  # pressure on side B [Pa]
    x: float  # of the spool [m]


def law_of(joint: np.ndarray) -> np.ndarray | None:
    """The law that a joint's record holds, its terms as rows of `LAW`; None if it has none. # (1,) -> (k,)."""
    terms = np.ascontiguousarray(joint["law"]).view(LAW)
    there = (terms["sine"] != 0.0) | (terms["cosine"] != 0.0)
    return terms[there] if there.any() else None


@njit
def time_factor(shape: float, t: float) -> float:
    """A factor of `TIMES`."""
    if shape == 1.0:
        return t
    return t * t if shape == 2.0 else 1.0


@njit
def place_factor(shape: float, z: float, off: float) -> float:
    """A factor of `PLACES`, off being how far from a place it is, over the reach."""
    if shape == 1.0:
        return z
    if shape == 2.0:
        return z * z
    if shape == 3.0:
        return 1.0 - z * z
    if shape == 4.0:
        return (0.5 * (1.0 + z)) ** 2
    if shape == 5.0:
        return (0.5 * (1.0 - z)) ** 2
    if shape == 6.0:
        return math.cos(0.5 * math.pi * off) ** 2 if abs(off) < 1.0 else 0.0
    return 1.0


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
def _without_speed(law: Any, seen: Seen) -> float:
    """A term's value but for its factor of the speed."""
    size = law.sine
    if law.frequency > 0.0:
        angle = 2.0 * math.pi * law.frequency * seen.time
        size = law.sine * math.sin(angle) + law.cosine * math.cos(angle)
    place = seen.stroke if law.at_rod > 0.0 else seen.q
    z = 2.0 * (place - law.low) / (law.high - law.low) - 1.0
    return (
        size
        * time_factor(law.time, seen.time / law.seconds)
        * place_factor(law.place, z, (place - law.centre) / law.reach)
        * other_factor(law.other, seen.p_a / law.pressure, seen.p_b / law.pressure, seen.x / law.opening)
    )


@njit
def law_value(law: Any, seen: Seen) -> float:
    """A term's value.

    Args:
        law: a record of `LAW`.
        seen: what it depends on.
    """
    v = seen.v if law.at_rod > 0.0 else seen.w
    return _without_speed(law, seen) * speed_factor(law.speed_shape, v / law.speed, math.tanh(v / law.slow))


@njit
def felt(probe: Probe, laws: np.ndarray | None, seen: Seen) -> Probe:
    """Probes with what the terms of a law add, if there is one."""
    if laws is None:  # known when this is compiled: the rollout without a law is a program of its own
        return probe
    for row in range(len(laws)):
        law = laws[row]
        probe = added(probe, law.probe, law_value(law, seen))
    return probe


@njit
def braking_slope(laws: np.ndarray | None, lever: float, seen: Seen) -> float:
    """Secant slope of a law's moment over the joint's speed where it brakes, else 0 [N m s/rad].

    What a stiff integrator must know of a friction.

    Args:
        laws: records of `LAW`, or None.
        lever: of the rod at the joint [m/rad].
        seen: what the law depends on.
    """
    if laws is None:
        return 0.0
    slope = 0.0
    for row in range(len(laws)):
        law = laws[row]
        if (law.probe != CYLINDER and law.probe != LOAD) or law.speed_shape == 0.0 or law.speed_shape == 3.0:
            continue
        v = seen.v if law.at_rod > 0.0 else seen.w
        secant = 1.0 / law.speed
        if law.speed_shape == 1.0:
            secant = math.tanh(v / law.slow) / v if abs(v) > 1e-6 * law.slow else 1.0 / law.slow
        elif law.speed_shape == 4.0:
            secant = abs(v) / law.speed**2
        arm = lever if law.at_rod > 0.0 else 1.0
        slope += _without_speed(law, seen) * secant * arm * arm
    return min(slope, 0.0)
