"""Whether what is named with a probability is right as often as that: the picture."""

import io
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.stats import binomtest

CONFIDENCE = 0.95


def calibration_png(bins: Sequence[Mapping[str, Any]]) -> bytes:
    """Share of right answers over the probability told, with Wilson's interval and the number of cases.

    Args:
        bins: as from `scoring.summary`; empty ones are left out.
    """
    figure = Figure(figsize=(6.0, 4.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    filled = [b for b in bins if b["of"]]
    for place, b in enumerate(filled):
        interval = binomtest(b["count"], b["of"]).proportion_ci(CONFIDENCE, method="wilson")
        axes.plot([place] * 2, [interval.low, interval.high], color="tab:blue")
        axes.plot(place, b["share"], "o", color="tab:blue", label=None if place else "share that was right")
        axes.plot(
            [place - 0.3, place + 0.3],
            [b["mean"]] * 2,
            color="tab:orange",
            label=None if place else "mean probability told",
        )
    axes.set_xticks(
        range(len(filled)), [f"{b['from']:g} to {b['to']:g}\n{b['count']} of {b['of']}" for b in filled]
    )
    axes.set(
        ylim=(-0.02, 1.02),
        xlabel="probability with which effects were named; how many were right",
        title=f"{sum(b['of'] for b in filled)} diagnoses that named effects; lines: {CONFIDENCE:.0%} intervals",
    )
    axes.title.set_fontsize("medium")
    axes.grid(axis="y", color="0.92")
    if filled:
        axes.set_xlim(-0.5, len(filled) - 0.5)
        axes.legend(loc="lower right", frameon=False)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=110)
    return data.getvalue()
