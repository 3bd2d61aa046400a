"""The replay as a PNG, for those without a browser."""

import io
import textwrap
from collections.abc import Sequence
from typing import Any

from hydrolek_drake.replay.comparison import Comparison
from hydrolek_drake.replay.panels import NOISE_COLOUR, SPAN_COLOUR, Panel, panels
from hydrolek_drake.replay.replay import Replay

_WIDTH_IN = 10.0
_WIDER_IN = 13.0  # with two columns
_ROW_IN = 0.95
_DOTS_PER_INCH = 110
_LINE_LETTERS = 125


def picture(replay: Replay, comparisons: tuple[Comparison, ...], title: str) -> bytes:
    """Measured against model with the worst stretches shaded, the residual and the command beneath."""
    sentence = comparisons[0].sentence() if comparisons else ""
    return plots_png([panels(replay, comparisons)], title, sentence)


def plots_png(columns: Sequence[Sequence[Panel]], title: str, sentence: str) -> bytes:
    """Stacks of panels side by side, all over the same time, with title and sentence above."""
    from matplotlib.figure import Figure  # without pyplot: no global state, no screen

    longest = max(columns, key=len)
    heading = "\n".join([title, *textwrap.wrap(sentence, _LINE_LETTERS)])
    height = _ROW_IN * sum(panel.height for panel in longest) + 0.9 + 0.2 * heading.count("\n")
    width = _WIDTH_IN if len(columns) == 1 else _WIDER_IN
    figure = Figure(figsize=(width, height), layout="constrained")
    grid: Any = figure.subplots(
        len(longest),
        len(columns),
        sharex=True,
        squeeze=False,
        height_ratios=[panel.height for panel in longest],
    )
    for column, stack in enumerate(columns):
        for panel, axis in zip(stack, grid[:, column], strict=False):
            _draw(panel, axis)
        for axis in grid[len(stack) :, column]:
            axis.set_visible(False)
        grid[len(stack) - 1, column].set_xlabel("time [s]", fontsize=9)
    grid[0, -1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, framealpha=0.9)
    figure.suptitle(heading, fontsize=9.5, x=0.01, ha="left")
    figure.align_ylabels(grid)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=_DOTS_PER_INCH)
    return data.getvalue()


def _draw(panel: Panel, axis: Any) -> None:
    for start, end in panel.spans:
        axis.axvspan(start, end, color=SPAN_COLOUR, alpha=0.35, linewidth=0)
    if panel.noise_band:
        axis.axhspan(-panel.noise_band, panel.noise_band, color=NOISE_COLOUR, alpha=0.35, linewidth=0)
    for line in panel.lines:
        style = {"drawstyle": "steps-post"} if line.stepped else {}
        axis.plot(line.time, line.values, color=line.colour, linewidth=1.1, label=line.name, **style)
    limits = panel.limits()
    if limits is not None:
        axis.set_ylim(*limits)
    if panel.heading:
        axis.set_title(panel.heading, fontsize=9, loc="left", fontweight="bold")
    name, _, unit = panel.title.partition(" [")
    axis.set_ylabel(f"{name}\n[{unit}", fontsize=8)
    axis.tick_params(labelsize=8)
    axis.grid(alpha=0.25, linewidth=0.5)
    axis.margins(x=0.005)
    axis.spines[["top", "right"]].set_visible(False)
