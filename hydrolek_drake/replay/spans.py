"""The stretches of time in which model and recording differ most."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.replay.noise import samples_in, smoothed

SMOOTHING_S = 0.1
"""Time over which the residual is averaged before it is judged: shorter than any movement of a joint."""

BEYOND_NOISE = 3.0
"""A smoothed residual beyond this many times the noise is no noise."""

SHOWN = 5
"""How many spans are named."""


@dataclass(frozen=True)
class Span:
    """A stretch in which the residual is large.

    Attributes:
        start: [s].
        end: [s].
        share: of the squared error of the whole signal.
        largest: largest residual in it, with its sign.
    """

    start: float
    end: float
    share: float
    largest: float


def worst_spans(time: np.ndarray, residual: np.ndarray, noise: float) -> tuple[Span, ...]:
    """Contiguous stretches where the smoothed residual exceeds 3 times the noise, worst first.

    Where the error never comes back to the noise, as in an integrating plant, this would be one stretch from
    beginning to end; the bound is therefore at least the residual's own rms. Stretches that are closer to
    each other than the smoothing time are one.

    Args:
        time: [s]. # (n,)
        residual: NaN where nothing can be compared. # (n,)
        noise: of the recorded signal.
    """
    finite = np.isfinite(residual)
    if not finite.any():
        return ()
    squared = np.where(finite, residual, 0.0) ** 2
    total = float(squared.sum())
    bound = max(BEYOND_NOISE * noise, float(np.sqrt(squared[finite].mean())))
    width = samples_in(SMOOTHING_S, time)
    large = np.abs(np.nan_to_num(smoothed(residual, width))) > bound
    if not large.any():
        return ()
    inside = np.flatnonzero(large)
    breaks = np.flatnonzero(np.diff(inside) > width)
    firsts = inside[np.concatenate([[0], breaks + 1])]
    lasts = inside[np.concatenate([breaks, [inside.size - 1]])]
    spans = []
    for first, last in zip(firsts.tolist(), lasts.tolist(), strict=True):
        part = np.where(finite, residual, 0.0)[first : last + 1]
        spans.append(
            Span(
                start=float(time[first]),
                end=float(time[last]),
                share=float(squared[first : last + 1].sum()) / total,
                largest=float(part[np.abs(part).argmax()]),
            )
        )
    return tuple(sorted(spans, key=lambda span: -span.share)[:SHOWN])
