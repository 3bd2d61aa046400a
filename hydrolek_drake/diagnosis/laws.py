"""Short laws in a stage's own variables, for physics that is in no list.

A law gives one unknown input of the rollout (`kernel.PROBES`) as a function of time or of the joint's movement.
Every law is one term with an amplitude; a periodic one has a frequency and a phase besides.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.rollout.kernel import PROBES
from hydrolek_drake.rollout.rollout import Signals

SLOW = 0.02
"""The sign of a speed is smoothed below this fraction of the largest speed."""


@dataclass(frozen=True)
class Input:
    """One unknown input.

    Attributes:
        stage: where it enters.
        probe: as what; one of `kernel.PROBES`.
        symbol: how a law names it.
        unit: SI unit, "1" for a relative change.
        scale: a large amplitude for this machine.
    """

    stage: str
    probe: str
    symbol: str
    unit: str
    scale: float


def inputs_of(scales: Scales, pressure: float, limit: float, position_unit: str) -> tuple[Input, ...]:
    """The unknown inputs of a joint; those of the hydraulics are left out where there are none (NaN scales).

    Args:
        scales: natural scales of the joint.
        pressure: of the supply [Pa].
        limit: largest command [V].
        position_unit: rad or m.
    """
    moment = "N m" if position_unit == "rad" else "N"
    inputs = [
        Input("command", "command", "voltage added to the command", "V", 0.3 * limit),
        Input("load", "load", "moment added at the joint" if moment == "N m" else "force added at the load", moment,
              0.3 * scales.load_force),
        Input("sensor", "sensor", "added to the reading", position_unit, 0.1 * scales.travel),
    ]  # fmt: skip
    if math.isfinite(scales.conductance):
        inputs += [
            Input("supply", "supply", "added to the supply pressure", "Pa", 0.3 * pressure),
            Input("amplifier", "amplifier", "relative change of the coil currents", "1", 0.3),
            Input("valve", "valve", "relative change of the valve's opening", "1", 0.6),
            Input("cylinder", "cylinder", "force added at the rod", "N", 0.3 * scales.force),
            Input(
                "fluid", "capacity_a", "volume taken per pressure on side A, added", "m^3/Pa", scales.capacity
            ),
            Input(
                "fluid", "capacity_b", "volume taken per pressure on side B, added", "m^3/Pa", scales.capacity
            ),
        ]
    return tuple(sorted(inputs, key=lambda i: PROBES.index(i.probe)))


@dataclass(frozen=True)
class Term:
    """A function of time and movement, of size about one.

    Attributes:
        name: as in an equation.
        stages: at which it has a physical meaning: a friction is no business of the pump's.
        values: (time since the start over the span's, variables) -> values. # (n,)
    """

    name: str
    stages: tuple[str, ...]
    values: Callable[[np.ndarray, Mapping[str, np.ndarray]], np.ndarray]


CONSTANT = "1"
"""Name of the term that does not vary."""

_FORCES = ("cylinder", "load")
_MOVED = (*_FORCES, "sensor")
_FLOWS = ("supply", "valve")
_ALL = ("command", "amplifier", "supply", "valve", "fluid", "cylinder", "load", "sensor")

TERMS = (
    Term(CONSTANT, _ALL, lambda t, s: np.ones(t.size)),
    Term("t/T", _ALL, lambda t, s: t),
    Term("(t/T)^2", _ALL, lambda t, s: t * t),
    Term("sign(v)", _MOVED, lambda t, s: s["sign"]),
    Term("v", (*_MOVED, *_FLOWS), lambda t, s: s["v"]),
    Term("|v|", _FLOWS, lambda t, s: np.abs(s["v"])),
    Term("v |v|", (*_FORCES, *_FLOWS), lambda t, s: s["v"] * np.abs(s["v"])),
    Term("z", (*_MOVED, "fluid"), lambda t, s: s["z"]),
    Term("z^2", _MOVED, lambda t, s: s["z"] ** 2),
    Term("z sign(v)", _FORCES, lambda t, s: s["z"] * s["sign"]),
    Term("z^2 sign(v)", _FORCES, lambda t, s: s["z"] ** 2 * s["sign"]),
    Term("(1 - z^2) sign(v)", _FORCES, lambda t, s: (1.0 - s["z"] ** 2) * s["sign"]),
    Term("((1 + z)/2)^2 sign(v)", _FORCES, lambda t, s: (0.5 * (1.0 + s["z"])) ** 2 * s["sign"]),
    Term("((1 - z)/2)^2 sign(v)", _FORCES, lambda t, s: (0.5 * (1.0 - s["z"])) ** 2 * s["sign"]),
    Term("z v", _FORCES, lambda t, s: s["z"] * s["v"]),
    Term("p_A", ("valve", "fluid", *_MOVED), lambda t, s: s["pa"]),
    Term("p_B", ("valve", "fluid", *_MOVED), lambda t, s: s["pb"]),
    Term("p_A - p_B", ("valve", *_MOVED), lambda t, s: s["pa"] - s["pb"]),
    Term("x", ("command", "amplifier", *_FLOWS), lambda t, s: s["x"]),
    Term("|x|", ("command", "amplifier", *_FLOWS), lambda t, s: np.abs(s["x"])),
)
"""t: time, T: duration of the longest training recording, v: speed over its largest in these, z: position from -1 to 1
over what they show, x: spool over its largest, p: pressure over the supply's (`Span`)."""


@dataclass(frozen=True)
class Span:
    """What the variables of the terms are told in, so that a law means the same in every recording.

    Attributes:
        speed: the largest [rad/s or m/s].
        low: end of the positions [rad or m].
        high: the other end.
        opening: the spool's largest [m].
        pressure: of the supply [Pa].
        seconds: of the longest recording.
    """

    speed: float
    low: float
    high: float
    opening: float
    pressure: float
    seconds: float


def span_of(signals: Sequence[Signals], pressure: float, seconds: float) -> Span:
    """The span of some rollouts."""
    position = np.concatenate([np.nan_to_num(s.position) for s in signals])
    return Span(
        speed=max(float(np.abs(np.nan_to_num(s.velocity)).max()) for s in signals) or 1.0,
        low=float(position.min()),
        high=float(position.max()),
        opening=max(float(np.abs(np.nan_to_num(s.spool)).max()) for s in signals) or 1.0,
        pressure=pressure if pressure > 0.0 else 1.0,
        seconds=seconds,
    )


def variables_of(signals: Signals, span: Span) -> dict[str, np.ndarray]:
    """The variables of the terms, without units, along a rollout. # (n,) each."""
    v = np.nan_to_num(signals.velocity) / span.speed
    position = np.nan_to_num(signals.position)
    return {
        "v": v,
        "sign": np.tanh(v / SLOW),
        "z": 2.0 * (position - span.low) / max(span.high - span.low, np.finfo(float).tiny) - 1.0,
        "x": np.nan_to_num(signals.spool) / span.opening,
        "pa": np.nan_to_num(signals.pressure_a) / span.pressure,
        "pb": np.nan_to_num(signals.pressure_b) / span.pressure,
    }


def probe_rows(probe: str, values: np.ndarray) -> np.ndarray:
    """One input over time as rows of `kernel.PROBES`. # (n, 10)."""
    rows = np.zeros((values.size, len(PROBES)))
    rows[:, PROBES.index(probe)] = values
    return rows
