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
    figure = Figure(figsize=(5.5, 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 1.0], color="0.7", label="calibrated")
    filled = [b for b in bins if b["of"]]
    for b in filled:
        interval = binomtest(b["count"], b["of"]).proportion_ci(CONFIDENCE, method="wilson")
        axes.plot([b["mean"]] * 2, [interval.low, interval.high], color="tab:blue", linewidth=1.5)
        axes.plot(b["mean"], b["share"], "o", color="tab:blue")
        beside = b["mean"] < 0.5  # text stays inside
        axes.annotate(
            f"{b['count']} of {b['of']}",
            (b["mean"], b["share"]),
            xytext=(8 if beside else -8, -4),
            textcoords="offset points",
            ha="left" if beside else "right",
            va="top",
        )
    axes.set(
        xlim=(-0.03, 1.03),
        ylim=(-0.03, 1.03),
        xlabel="probability with which effects were named",
        ylabel="share of right answers",
        title=f"{sum(b['of'] for b in filled)} diagnoses that named effects; lines: {CONFIDENCE:.0%} intervals",
    )
    axes.title.set_fontsize("medium")
    axes.grid(color="0.92")
    axes.legend(loc="upper left", frameon=False)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=110)
    return data.getvalue()
