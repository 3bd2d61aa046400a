"""The replay as a PNG, for those without a browser."""

import io
import textwrap
from typing import Any

from hydrolek_drake.replay.comparison import Comparison
from hydrolek_drake.replay.panels import NOISE_COLOUR, SPAN_COLOUR, panels
from hydrolek_drake.replay.replay import Replay

_WIDTH_IN = 10.0
_ROW_IN = 0.95
_DOTS_PER_INCH = 110
_LINE_LETTERS = 125


def picture(replay: Replay, comparisons: tuple[Comparison, ...], title: str) -> bytes:
    """Measured against model with the worst stretches shaded, the residual and the command beneath."""
    from matplotlib.figure import Figure  # without pyplot: no global state, no screen

    stack = panels(replay, comparisons)
    heading = "\n".join(
        [title, *textwrap.wrap(comparisons[0].sentence(), _LINE_LETTERS)] if comparisons else [title]
    )
    height = _ROW_IN * sum(panel.height for panel in stack) + 0.9 + 0.2 * heading.count("\n")
    figure = Figure(figsize=(_WIDTH_IN, height), layout="constrained")
    axes: Any = figure.subplots(
        len(stack), 1, sharex=True, squeeze=False, height_ratios=[panel.height for panel in stack]
    )[:, 0]
    for panel, axis in zip(stack, axes, strict=True):
        for start, end in panel.spans:
            axis.axvspan(start, end, color=SPAN_COLOUR, alpha=0.35, linewidth=0)
        if panel.noise_band:
            axis.axhspan(-panel.noise_band, panel.noise_band, color=NOISE_COLOUR, alpha=0.35, linewidth=0)
        for line in panel.lines:
            style = {"drawstyle": "steps-post"} if line.stepped else {}
            axis.plot(line.time, line.values, color=line.colour, linewidth=1.1, label=line.name, **style)
        name, _, unit = panel.title.partition(" [")
        axis.set_ylabel(f"{name}\n[{unit}", fontsize=8)
        axis.tick_params(labelsize=8)
        axis.grid(alpha=0.25, linewidth=0.5)
        axis.margins(x=0.005)
        axis.spines[["top", "right"]].set_visible(False)
        if axis is axes[0]:
            axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, framealpha=0.9)
    axes[-1].set_xlabel("time [s]", fontsize=9)
    figure.suptitle(heading, fontsize=9.5, x=0.01, ha="left")
    figure.align_ylabels(axes)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=_DOTS_PER_INCH)
    return data.getvalue()
