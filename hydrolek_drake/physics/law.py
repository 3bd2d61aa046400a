"""A short law as feedback: inputs from outside (`probes`) as functions of time and of the joint's own state.

value = sum of (a sin 2 pi f t + b cos 2 pi f t, or a where f = 0) * time * place * speed * other

with one factor out of each of the lists below in every term. Place and speed are those of the stage: of the rod where
the term acts in the hydraulics, else of the joint. The law is evaluated within the rollout: a friction that was given
as a course in time could not hold a joint that sticks.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload

from hydrolek_drake.compiling import COMPILED, njit
from hydrolek_drake.physics.probes import (
    AMPLIFIER,
    COIL_TIME,
    COMMAND,
    CYLINDER,
    FLOW_FORCE,
    LOAD,
    RAMP,
    Probe,
    added,
)
from hydrolek_drake.physics.smooth import (
    cosine_up_to_quarter,
    hyperbolic_tangent,
    sine_and_cosine_of_turns,
)

TIMES = ("1", "t/T", "(t/T)^2")
NEAR = "near"
"""At one place of the movement alone: half a wave of cosine squared around `centre`, nothing beyond `reach` from it
(a Hann window; several half their width apart add up to 1 between them)."""

BEYOND, BELOW = "beyond", "below"
"""From one place of the movement on, in proportion to the way past `centre`, over `reach`: what is pulled tight or
touched there (a spring with a gap)."""

PLACED = {NEAR: ("centre", "reach"), BEYOND: ("centre",), BELOW: ("centre",)}
"""Factors that act at a place -> which numbers of theirs are the law's own, and not told by the movement."""

PLACES = ("1", "z", "z^2", "(1 - z^2)", "((1 + z)/2)^2", "((1 - z)/2)^2", NEAR, BEYOND, BELOW)
SPEEDS = ("1", "sign(v)", "v", "|v|", "v |v|")
OTHERS = ("1", "p_A", "p_B", "(p_A - p_B)", "x", "|x|")
"""t: time since switching on, T: `seconds`, z: stroke or position, -1 at `low` and 1 at `high`; near:
cos(pi/2 d)^2 with d the distance from `centre` over `reach`, and 0 beyond 1; beyond, below: max(d, 0), max(-d, 0);
v: speed over `speed`, sign(v): tanh(v over `slow`), p: pressure over `pressure`, x: spool over `opening`."""

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


def any_gives(joints: np.ndarray, probe: int) -> bool:
    """Whether the law of any of some joints' records gives an input, told by its place in `probes.PROBES`."""
    laws = (law_of(joints[i : i + 1]) for i in range(len(joints)))
    return any(law is not None and bool(np.any(law["probe"] == probe)) for law in laws)


@njit
def _time_factor(law: Any, seen: Seen) -> float:
    """A factor of `TIMES`."""
    if law.time == 1.0:
        return seen.time / law.seconds
    return (seen.time / law.seconds) ** 2 if law.time == 2.0 else 1.0


@njit
def _place_factor(law: Any, seen: Seen) -> float:
    """A factor of `PLACES`."""
    shape = law.place
    if shape == 0.0:
        return 1.0
    place = seen.stroke if law.at_rod > 0.0 else seen.q
    if shape >= 6.0:
        off = (place - law.centre) / law.reach
        if shape == 6.0:
            return cosine_up_to_quarter(0.5 * math.pi * min(abs(off), 1.0)) ** 2 if abs(off) < 1.0 else 0.0
        return max(off, 0.0) if shape == 7.0 else max(-off, 0.0)
    z = 2.0 * (place - law.low) / (law.high - law.low) - 1.0
    if shape == 1.0:
        return z
    if shape == 2.0:
        return z * z
    if shape == 3.0:
        return 1.0 - z * z
    return (0.5 * (1.0 + z)) ** 2 if shape == 4.0 else (0.5 * (1.0 - z)) ** 2


@njit
def _other_factor(law: Any, seen: Seen) -> float:
    """A factor of `OTHERS`."""
    shape = law.other
    of_pressure = seen.p_a if shape == 1.0 else seen.p_b if shape == 2.0 else seen.p_a - seen.p_b
    of_spool = seen.x if shape == 4.0 else abs(seen.x)
    # Both are formed: of numbers that are loaded in either branch the compiler makes a load from one of two places,
    # which keeps machines in lanes from vector instructions.
    relative_pressure, relative_opening = of_pressure / law.pressure, of_spool / law.opening
    return 1.0 if shape == 0.0 else relative_pressure if shape <= 3.0 else relative_opening


SecantAndSlope = tuple[float, float]
"""Secant and slope of a moment over the joint's speed [N m s/rad]."""


@njit
def _speed_factor(law: Any, seen: Seen) -> tuple[float, float, float]:
    """A factor of `SPEEDS`; for one that changes its sign with the speed v also the factor over v and its slope."""
    shape = law.speed_shape
    if shape == 0.0:
        return 1.0, 0.0, 0.0
    v = seen.v if law.at_rod > 0.0 else seen.w
    if shape == 1.0:
        sign = hyperbolic_tangent(v / law.slow)
        secant = sign / v if abs(v) > 1e-6 * law.slow else 1.0 / law.slow
        return sign, secant, (1.0 - sign * sign) / law.slow
    relative = v / law.speed
    if shape == 2.0:
        return relative, 1.0 / law.speed, 1.0 / law.speed
    if shape == 3.0:
        return abs(relative), 0.0, 0.0
    return relative * abs(relative), abs(relative) / law.speed, 2.0 * abs(relative) / law.speed


@njit
def _value_and_slopes(law: Any, seen: Seen) -> tuple[float, float, float]:
    """A term's value, and its secant and slope over the speed where it changes its sign with it, else 0."""
    size = law.sine
    if law.frequency > 0.0:
        sine, cosine = sine_and_cosine_of_turns(law.frequency * seen.time)
        size = law.sine * sine + law.cosine * cosine
    size *= _time_factor(law, seen) * _place_factor(law, seen) * _other_factor(law, seen)
    factor, secant, slope = _speed_factor(law, seen)
    return size * factor, size * secant, size * slope


@njit
def law_value(law: Any, seen: Seen) -> float:
    """A term's value.

    Args:
        law: a record of `LAW`.
        seen: what it depends on.
    """
    return _value_and_slopes(law, seen)[0]


@njit
def _with_term(
    law: Any, probe: Probe, slopes: SecantAndSlope, lever: float, seen: Seen
) -> tuple[Probe, SecantAndSlope]:
    """Probes and slopes of `felt` with those of one more term."""
    value, secant, slope = _value_and_slopes(law, seen)
    arm = lever if law.at_rod > 0.0 else 1.0
    squared = arm * arm if law.probe == CYLINDER or law.probe == LOAD else 0.0
    return added(probe, law.probe, value), (slopes[0] + secant * squared, slopes[1] + slope * squared)


def _with_terms(laws: Any, probe: Any, slopes: Any, lever: Any, seen: Any) -> Any:
    """Probes and slopes with those of all terms; compiled code takes one of the forms below."""
    for row in range(len(laws)):
        probe, slopes = _with_term(laws[row], probe, slopes, lever, seen)
    return probe, slopes


def _without_terms(laws: Any, probe: Any, slopes: Any, lever: Any, seen: Any) -> Any:
    return probe, slopes


def _unrolled(laws: Any, probe: Any, slopes: Any, lever: Any, seen: Any) -> Any:
    probe, slopes = _with_term(laws[0], probe, slopes, lever, seen)
    return _with_terms(laws[1:], probe, slopes, lever, seen)


@overload(_with_terms, jit_options=COMPILED)
def _form_of_terms(laws: Any, probe: Any, slopes: Any, lever: Any, seen: Any) -> Any:
    if not isinstance(laws, types.BaseTuple):
        return _with_terms
    return _unrolled if len(laws) else _without_terms  # a loop would keep lanes from vector instructions


@njit
def felt(probe: Probe, laws: Any, lever: float, seen: Seen) -> tuple[Probe, SecantAndSlope]:
    """Probes with what the terms of a law add, if there is one, and how a stiff integrator sees its frictions.

    Args:
        probe: from outside.
        laws: records of `LAW` in an array or a tuple, or None.
        lever: of the rod at the joint [m/rad].
        seen: what the law depends on.

    Returns:
        The probes, and the secant and the slope of the law's moment over the joint's speed where it brakes, else 0
        [N m s/rad]; see `friction.slope_of_growth`.
    """
    if laws is None:  # known when this is compiled: the rollout without a law is a program of its own
        return probe, (0.0, 0.0)
    probe, slopes = _with_terms(laws, probe, (0.0, 0.0), lever, seen)
    return probe, (min(slopes[0], 0.0), min(slopes[1], 0.0))


@njit
def up_to_the_spool(laws: np.ndarray | None) -> bool:
    """Whether a law acts before the spool or on it, which is advanced ahead of the rest of a step."""
    if laws is None:
        return False
    for row in range(len(laws)):
        probe = laws[row].probe
        if (
            probe == COMMAND
            or probe == AMPLIFIER
            or probe == RAMP
            or probe == COIL_TIME
            or probe == FLOW_FORCE
        ):
            return True
    return False
