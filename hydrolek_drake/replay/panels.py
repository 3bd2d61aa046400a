"""What the pictures of a replay show, from top to bottom; drawn alike in the browser and on paper."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.replay.comparison import Comparison
from hydrolek_drake.replay.display import display_factor, display_unit
from hydrolek_drake.replay.replay import Replay
from hydrolek_drake.replay.spans import BEYOND_NOISE
from hydrolek_drake.replay.thinning import thinned

MEASURED_COLOUR = "#222222"
MODEL_COLOUR = "#d95f02"
RESIDUAL_COLOUR = "#1b6ca8"
COMMAND_COLOUR = "#555555"
SPAN_COLOUR = "#f2c14e"
NOISE_COLOUR = "#9aa5b1"


@dataclass(frozen=True)
class Line:
    """One curve, already thinned and in units that people use."""

    name: str
    time: np.ndarray
    values: np.ndarray
    colour: str
    stepped: bool = False


@dataclass(frozen=True)
class Panel:
    """One plot of the stack.

    Attributes:
        title: axis title with unit.
        lines: curves.
        spans: start and end of the worst stretches, to be shaded.
        noise_band: half height of the band that noise alone fills, or None.
        height: relative to the others.
        least_span: what the axis shows at least, so that a signal at rest looks like one.
        heading: of the column, in its first panel.
    """

    title: str
    lines: tuple[Line, ...]
    spans: tuple[tuple[float, float], ...]
    noise_band: float | None
    height: float
    least_span: float = 0.0
    heading: str = ""

    def limits(self) -> tuple[float, float] | None:
        """Ends of the axis where the signal alone would not fill `least_span`; None to leave it to the plot."""
        values = np.concatenate([line.values for line in self.lines])
        values = values[np.isfinite(values)]
        if not values.size or np.ptp(values) >= self.least_span:
            return None
        middle = 0.5 * float(values.min() + values.max())
        return middle - 0.6 * self.least_span, middle + 0.6 * self.least_span


def panels(replay: Replay, comparisons: tuple[Comparison, ...]) -> list[Panel]:
    """Every signal with its residual beneath, and the commands at the bottom."""
    time = replay.recording.time
    stack = []
    for pair, comparison in zip(replay.pairs, comparisons, strict=True):
        factor, unit = display_factor(pair.unit), display_unit(pair.unit)
        spans = tuple((span.start, span.end) for span in comparison.spans)
        curves = (
            ("measured", pair.measured, MEASURED_COLOUR),
            ("model", pair.model, MODEL_COLOUR),
        )
        stack.append(
            Panel(
                f"{pair.key} [{unit}]",
                tuple(Line(name, *thinned(time, factor * values), colour) for name, values, colour in curves),
                spans,
                None,
                2.2,
            )
        )
        stack.append(
            Panel(
                f"residual [{unit}]",
                (Line("measured - model", *thinned(time, factor * pair.residual), RESIDUAL_COLOUR),),
                spans,
                BEYOND_NOISE * factor * comparison.noise,
                1.0,
            )
        )
    for joint, command in replay.commands.items():
        line = Line(f"{joint}.command", *thinned(time, command), COMMAND_COLOUR, stepped=True)
        stack.append(Panel(f"{joint}.command [V]", (line,), (), None, 0.8))
    return stack
