"""Short laws in a stage's own variables, for physics that is in no list.

A law gives one unknown input of the rollout (`probes.PROBES`) as a function of time or of the movement at its stage.
It is a sum of one to three terms, each with an amplitude; a periodic one has a frequency and a phase instead. What the
factors of a term mean stands in `physics.law`, which evaluates them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.physics.law import BELOW, BEYOND, LAW, NEAR, OTHERS, PLACED, PLACES, SPEEDS, TIMES
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.rollout.one_point import stroke_and_lever
from hydrolek_drake.rollout.rollout import Signals

CONSTANT = "1"
"""Name of the term that does not vary."""


@dataclass(frozen=True)
class Term:
    """A function of time and movement, of size about one: a product of factors of `physics.law`.

    Attributes:
        stages: at which it has a physical meaning: a friction is no business of the pump's.
        time: factor of `TIMES`.
        place: of `PLACES`.
        speed: of `SPEEDS`.
        other: of `OTHERS`.
        centre: near which place of the movement, or from which on, -1 at its low end and 1 at its high one; where a
            fit begins.
        reach: how far to either side, half of the movement being 1; so far past the place an amplitude is told.
    """

    stages: tuple[str, ...]
    time: str = "1"
    place: str = "1"
    speed: str = "1"
    other: str = "1"
    centre: float = 0.0
    reach: float = 1.0

    def meant_for(self, given: Input) -> bool:
        """Whether it has a physical meaning at an input."""
        return given.stage in self.stages and (not given.one_sided or self.name == CONSTANT)

    def is_listed(self, given: Input) -> bool:
        """Whether it says nothing at an input that an effect of the list does not: Coulomb friction of the rod.

        That of the joint is only searched where a rig has a link that weighs, or no oil.
        """
        return self.name == "sign(v)" and given.stage == "cylinder"

    @property
    def name(self) -> str:
        """As in an equation."""
        factors = [f for f in (self.time, self.place, self.speed, self.other) if f != "1"]
        return " ".join(factors) or CONSTANT


_FORCES = ("cylinder", "load")
_MOVED = (*_FORCES, "sensor")
_FLOWS = ("supply", "valve")
_ALL = ("command", "amplifier", "supply", "valve", "fluid", "cylinder", "load", "sensor")

TERMS = (
    Term(_ALL),
    Term(_ALL, time="t/T"),
    Term(_ALL, time="(t/T)^2"),
    Term(_MOVED, speed="sign(v)"),
    Term((*_MOVED, *_FLOWS), speed="v"),
    Term(_FLOWS, speed="|v|"),
    Term((*_FORCES, *_FLOWS), speed="v |v|"),
    Term((*_MOVED, "fluid"), place="z"),
    Term(_MOVED, place="z^2"),
    Term(_FORCES, place="z", speed="sign(v)"),
    Term(_FORCES, place="z^2", speed="sign(v)"),
    Term(_FORCES, place="(1 - z^2)", speed="sign(v)"),
    Term(_FORCES, place="((1 + z)/2)^2", speed="sign(v)"),
    Term(_FORCES, place="((1 - z)/2)^2", speed="sign(v)"),
    *(Term(_FORCES, place=NEAR, speed="sign(v)", centre=0.25 * n, reach=0.5) for n in range(-3, 4)),
    *(Term(_FORCES, place=past, centre=0.5 * n) for past in (BEYOND, BELOW) for n in range(-1, 2)),
    # where a wiper mostly stands, it wears a short piece of its track
    *(Term(("sensor",), place=NEAR, centre=0.125 * n, reach=0.25) for n in range(-7, 8)),
    Term(_FORCES, place="z", speed="v"),
    Term(("valve", "fluid", *_MOVED), other="p_A"),
    Term(("valve", "fluid", *_MOVED), other="p_B"),
    Term(("valve", *_MOVED), other="(p_A - p_B)"),
    Term(("command", "amplifier", *_FLOWS), other="x"),
    Term(("command", "amplifier", *_FLOWS), other="|x|"),
)


@dataclass(frozen=True)
class Reach:
    """How a joint, or its rod, moved.

    Attributes:
        speed: the largest [rad/s or m/s].
        slow: below which the sign of a speed is smoothed, as the rig's friction is [rad/s or m/s].
        low: end of the positions [rad or m].
        high: the other end.
        unit: of the positions.
    """

    speed: float
    slow: float
    low: float
    high: float
    unit: str

    def position(self, z: float) -> float:
        """Where z is, which is -1 at the low end and 1 at the high one [rad or m]."""
        return self.low + self.distance(1.0 + z)

    def distance(self, z: float) -> float:
        """How long a piece of z is [rad or m]."""
        return 0.5 * z * (self.high - self.low)


@dataclass(frozen=True)
class Span:
    """What the variables of the terms are told in, so that a law means the same in every recording.

    Attributes:
        joint: how it moved.
        rod: how the rod moved; None in a machine without oil.
        opening: the spool's largest [m].
        pressure: of the supply [Pa].
        seconds: of the longest recording.
    """

    joint: Reach
    rod: Reach | None
    opening: float
    pressure: float
    seconds: float

    def at(self, probe: str) -> Reach:
        """How what an input acts on moved: the rod in the hydraulics, else the joint."""
        return self.joint if self.rod is None or probe in BEYOND_THE_ROD else self.rod


BEYOND_THE_ROD = ("load", "sensor")
"""Inputs that see the joint's position and speed; all others see the rod's."""


def span_of(
    signals: Sequence[Signals], record: np.void, seconds: float, position_unit: str, rod_unit: str = "m"
) -> Span:
    """The span of some rollouts.

    Args:
        signals: of the training recordings.
        record: the joint's parameters.
        seconds: of the longest recording.
        position_unit: rad or m.
        rod_unit: m, or rad where a vane turns the joint.
    """
    position = np.concatenate([np.nan_to_num(s.position) for s in signals])
    velocity = np.concatenate([np.nan_to_num(s.velocity) for s in signals])
    pressure = float(record["supply"]["pressure"])
    smoothed = float(record["cylinder"]["friction_velocity"])
    rod = None
    if math.isfinite(smoothed):
        pairs = [stroke_and_lever(q, record) for q in position.tolist()]
        stroke, lever = np.array(pairs).T
        rod = _reach(stroke, lever * velocity, smoothed, rod_unit)
        _, middle = stroke_and_lever(0.5 * float(position.min() + position.max()), record)
        smoothed /= abs(middle)
    else:
        smoothed = float(record["load"]["friction_velocity"])
    return Span(
        joint=_reach(position, velocity, smoothed, position_unit),
        rod=rod,
        opening=max(float(np.abs(np.nan_to_num(s.spool)).max()) for s in signals) or 1.0,
        pressure=pressure if pressure > 0.0 else 1.0,
        seconds=seconds,
    )


def _reach(position: np.ndarray, velocity: np.ndarray, slow: float, unit: str) -> Reach:
    low, high = float(position.min()), float(position.max())
    return Reach(
        speed=float(np.abs(velocity).max()) or 1.0,
        slow=slow,
        low=low,
        high=high if high > low else low + 1.0,
        unit=unit,
    )


def law_record(
    probe: str, span: Span, term: Term | None, sine: float, cosine: float = 0.0, frequency: float = 0.0
) -> np.ndarray:
    """One term of a law as the rollout takes it. # (1,) of `physics.law.LAW`.

    Args:
        probe: what it gives; one of `probes.PROBES`.
        span: what its variables are told in.
        term: its form; None for a periodic one.
        sine: amplitude [SI].
        cosine: of the cosine, for a periodic one.
        frequency: of a periodic one [Hz].
    """
    record = np.zeros(1, LAW)
    record["probe"] = PROBES.index(probe)
    if term is not None:
        record["time"] = TIMES.index(term.time)
        record["place"] = PLACES.index(term.place)
        record["speed_shape"] = SPEEDS.index(term.speed)
        record["other"] = OTHERS.index(term.other)
    record["sine"], record["cosine"], record["frequency"] = sine, cosine, frequency
    reach = span.at(probe)
    record["at_rod"] = float(reach is span.rod)
    for name in ("low", "high", "speed", "slow"):
        record[name] = getattr(reach, name)
    placed = term if term is not None and term.place in PLACED else None
    record["centre"] = reach.position(placed.centre) if placed is not None else 0.0
    record["reach"] = reach.distance(placed.reach) if placed is not None else 1.0
    for name in ("seconds", "opening", "pressure"):
        record[name] = getattr(span, name)
    return record


def law_records(probe: str, span: Span, terms: Sequence[Term], amplitudes: Sequence[float]) -> np.ndarray:
    """A law of one or more terms. # (k,) of `physics.law.LAW`; arguments as of `law_record`."""
    return np.concatenate(
        [law_record(probe, span, term, size) for term, size in zip(terms, amplitudes, strict=True)]
    )
