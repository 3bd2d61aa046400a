"""How far model and recording are apart, signal by signal."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.replay.conditions import TELLING, Condition, conditions_of, growth, shares
from hydrolek_drake.replay.display import shown
from hydrolek_drake.replay.noise import noise_level
from hydrolek_drake.replay.readings import Pair
from hydrolek_drake.replay.replay import Replay
from hydrolek_drake.replay.spans import Span, worst_spans

AGREEMENT = 1.1
"""Model and recording agree if the residual's rms is at most this many times the noise.

A perfect model leaves 1.0; the estimate of the noise itself is good to a few per cent.
"""

_FAR = 1000.0
"""Beyond this many times the noise the number says nothing more."""


@dataclass(frozen=True)
class Comparison:
    """One signal's error; all in the signal's SI unit.

    Attributes:
        key: `<joint>.<quantity>`.
        unit: SI unit.
        samples: how many could be compared.
        rms: root mean square of measured minus model.
        largest: largest error, with its sign.
        largest_at: when [s].
        mean: mean error (bias).
        noise: of the recorded signal, see `noise.noise_level`.
        spans: where the error is worst, worst first.
        conditions: share of the squared error by condition, most telling first.
        growing: share of the squared growth of the error by condition; positions only.
    """

    key: str
    unit: str
    samples: int
    rms: float
    largest: float
    largest_at: float
    mean: float
    noise: float
    spans: tuple[Span, ...]
    conditions: tuple[Condition, ...]
    growing: tuple[Condition, ...]

    @property
    def rms_over_noise(self) -> float:
        """1 for a model that leaves nothing but noise; infinite for a recording without noise."""
        if self.noise > 0.0:
            return self.rms / self.noise
        return 1.0 if self.rms == 0.0 else float("inf")

    @property
    def agrees(self) -> bool:
        """Whether nothing but noise is left."""
        return self.samples > 0 and self.rms_over_noise <= AGREEMENT

    def sentence(self) -> str:
        """What an engineer would say about this signal."""
        if not self.samples:
            return f"{self.key}: nothing could be compared."
        if self.agrees:
            return (
                f"{self.key}: model and recording agree to the noise "
                f"({shown(self.rms, self.unit)} rms, noise {shown(self.noise, self.unit)})."
            )
        text = (
            f"{self.key}: model and recording differ by {shown(self.rms, self.unit)} rms, "
            f"{times_of(self.rms_over_noise)} the noise of {shown(self.noise, self.unit)}"
        )
        where, grows = _most_telling(self.conditions), _most_telling(self.growing)
        parts = []
        if where:
            parts.append(f"the error is largest {where.name} ({_in_numbers(where, 'error')})")
        if grows:
            place = "there too" if where and where.name == grows.name else grows.name
            parts.append(f"it grows most {place} ({_in_numbers(grows, 'growth')})")
        if not parts and self.conditions:
            parts.append("the error is spread over all conditions")
        return f"{'; '.join([text, ' and '.join(parts)]) if parts else text}."


def times_of(ratio: float) -> str:
    """A ratio to the noise in words."""
    return f"{ratio:.3g} times" if ratio < _FAR else f"more than {_FAR:g} times"


def _most_telling(conditions: tuple[Condition, ...]) -> Condition | None:
    return conditions[0] if conditions and conditions[0].excess >= TELLING else None


def _in_numbers(condition: Condition, what: str) -> str:
    error, time = 100 * condition.of_error, 100 * condition.of_time
    return f"{error:.0f} % of the squared {what} in {time:.0f} % of the time"


def compare(replay: Replay) -> tuple[Comparison, ...]:
    """Compare every signal that was recorded and modelled, positions first."""
    return tuple(_compared(pair, replay) for pair in replay.pairs)


def _compared(pair: Pair, replay: Replay) -> Comparison:
    time, residual = replay.recording.time, pair.residual
    finite = np.isfinite(residual)
    noise = noise_level(pair.measured)
    if not finite.any():
        nan = float("nan")
        return Comparison(pair.key, pair.unit, 0, nan, nan, nan, nan, noise, (), (), ())
    known = residual[finite]
    at = int(np.abs(known).argmax())
    conditions: tuple[Condition, ...] = ()
    growing: tuple[Condition, ...] = ()
    if pair.joint is not None:
        holds = conditions_of(
            replay.rig, pair.joint, replay.commands[pair.joint], replay.outcomes[pair.joint].signals
        )
        conditions = shares(time, residual, holds)
        if pair.unit != "Pa":
            growing = shares(time, growth(time, residual), holds)
    return Comparison(
        key=pair.key,
        unit=pair.unit,
        samples=int(finite.sum()),
        rms=float(np.sqrt(np.mean(known**2))),
        largest=float(known[at]),
        largest_at=float(time[finite][at]),
        mean=float(known.mean()),
        noise=noise,
        spans=worst_spans(time, residual, noise),
        conditions=conditions,
        growing=growing,
    )
