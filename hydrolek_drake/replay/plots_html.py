"""Panels as interactive plots for a page that needs no network."""

from collections.abc import Sequence
from typing import Any

from hydrolek_drake.replay.panels import NOISE_COLOUR, SPAN_COLOUR, Panel
from hydrolek_drake.replay.plotly_page import figure_html, packed_plotly

_ROW_PX = 105
_HEADING_PX = 28


def plots_html(columns: Sequence[Sequence[Panel]]) -> str:
    """Stacks of panels side by side, all over the same time, as HTML that needs no network."""
    return figure_html(plots_figure(columns)) + packed_plotly()


def plots_figure(columns: Sequence[Sequence[Panel]]) -> Any:
    """The same as a Plotly figure; panels of one row have the same height."""
    from plotly.graph_objects import Figure, Scatter
    from plotly.subplots import make_subplots

    rows = max(len(stack) for stack in columns)
    longest = max(columns, key=len)
    height = int(_ROW_PX * sum(panel.height for panel in longest))
    headings = [stack[0].heading for stack in columns]
    headed = _HEADING_PX if any(headings) else 0
    figure: Any = make_subplots(
        rows=rows,
        cols=len(columns),
        shared_xaxes="all" if len(columns) > 1 else True,
        vertical_spacing=0.25 / (4 * rows),
        horizontal_spacing=0.09,
        row_heights=[panel.height for panel in longest],
        column_titles=[f"<b>{heading}</b>" for heading in headings] if headed else None,
        figure=Figure(),
    )
    named: set[str] = set()
    for column, stack in enumerate(columns, start=1):
        for row, panel in enumerate(stack, start=1):
            _draw(figure, Scatter, panel, {"row": row, "col": column}, named)
        figure.update_xaxes(title_text="time [s]", row=len(stack), col=column)
    figure.update_annotations(font_size=13)  # the headings
    figure.update_yaxes(title_font_size=11, gridcolor="#e4e9ee", zerolinecolor="#c7d0d9")
    figure.update_xaxes(gridcolor="#e4e9ee")
    figure.update_layout(
        height=height + 120 + headed,
        plot_bgcolor="white",
        margin={"l": 80, "r": 20, "t": 40 + headed, "b": 50},
        legend={"orientation": "h", "y": 1.0 + headed / height, "yanchor": "bottom", "x": 0},
        hovermode="x unified",
    )
    return figure


def _draw(figure: Any, scatter: Any, panel: Panel, place: dict[str, int], named: set[str]) -> None:
    for line in panel.lines:
        figure.add_trace(
            scatter(
                x=line.time,
                y=line.values,
                name=line.name,
                legendgroup=line.name,
                showlegend=line.name not in named,
                line={"color": line.colour, "width": 1.4, "shape": "hv" if line.stepped else "linear"},
            ),
            **place,
        )
        named.add(line.name)
    for start, end in panel.spans:
        figure.add_vrect(
            x0=start, x1=end, fillcolor=SPAN_COLOUR, opacity=0.3, line_width=0, layer="below", **place
        )
    if panel.noise_band:
        figure.add_hrect(
            y0=-panel.noise_band, y1=panel.noise_band, fillcolor=NOISE_COLOUR, opacity=0.3, line_width=0,
            layer="below", **place,
        )  # fmt: skip
    figure.update_yaxes(title_text=panel.title.replace(" [", "<br>["), **place)
    limits = panel.limits()
    if limits is not None:
        figure.update_yaxes(range=limits, **place)
