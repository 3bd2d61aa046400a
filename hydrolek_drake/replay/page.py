"""The replay as one HTML file that needs no network."""

import html
from collections.abc import Iterable
from typing import Any

from hydrolek_drake.replay.comparison import Comparison, times_of
from hydrolek_drake.replay.display import display_factor, display_unit
from hydrolek_drake.replay.panels import NOISE_COLOUR, SPAN_COLOUR, panels
from hydrolek_drake.replay.replay import Replay

_ROW_PX = 105
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1f2933; max-width: 1100px; margin: 2rem auto;
padding: 0 1rem }
h1 { font-size: 1.3rem; margin-bottom: .3rem } h2 { font-size: 1.05rem; margin-top: 2rem }
p.sentence { font-size: 1.1rem; margin: .4rem 0 } p.other, li, td, th { font-size: .92rem }
table { border-collapse: collapse; margin: .5rem 0 } td, th { padding: .3rem .8rem; text-align: right;
border-bottom: 1px solid #d9e0e7; white-space: nowrap } th { color: #52606d; font-weight: 600 }
td:first-child, th:first-child, td.text, th.text { text-align: left }
th.wide { white-space: normal; max-width: 9em }
.key { display: inline-block; width: 1.6em; height: .8em; margin: 0 .3em 0 0 }
.key:not(:first-child) { margin-left: 1.5em }
"""


def page(replay: Replay, comparisons: tuple[Comparison, ...], title: str) -> str:
    """The sentence first, then numbers, then the plots."""
    sentences = [html.escape(comparison.sentence()) for comparison in comparisons]
    parts = [
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
        f"<style>{_STYLE}</style></head><body><h1>{html.escape(title)}</h1>",
        *(
            f"<p class='{'other' if index else 'sentence'}'>{sentence}</p>"
            for index, sentence in enumerate(sentences)
        ),
        _remarks(replay),
        "<h2>Signals</h2>",
        _table(comparisons),
        "<h2>Over time</h2>",
        f"<p class='other'>{_key(SPAN_COLOUR, 'worst stretches')}"
        f"{_key(NOISE_COLOUR, '3 times the noise of the recording')}</p>",
        _plots(replay, comparisons),
        "<h2>By condition</h2>",
        _conditions(replay, comparisons),
        "</body></html>",
    ]
    return "\n".join(parts)


def _key(colour: str, meaning: str) -> str:
    return f"<span class='key' style='background:{colour}66'></span>{meaning}"


def _remarks(replay: Replay) -> str:
    remarks = [*replay.notes, *(finding.message for finding in replay.recording.findings)]
    if not remarks:
        return ""
    return "<ul>" + "".join(f"<li>{html.escape(remark)}</li>" for remark in remarks) + "</ul>"


def _table(comparisons: tuple[Comparison, ...]) -> str:
    titles = ("signal", "rms", "noise", "rms / noise", "mean", "largest")
    head = "".join(f"<th>{title}</th>" for title in titles)
    rows = [f"<tr>{head}<th class='text'>worst stretches (share of the squared error)</th></tr>"]
    for c in comparisons:
        factor, unit = display_factor(c.unit), display_unit(c.unit)
        name = f"{html.escape(c.key)}&nbsp;[{unit}]"
        if not c.samples:
            rows.append(
                f"<tr><td>{name}</td><td class='text' colspan='6'>nothing could be compared</td></tr>"
            )
            continue
        spans = "<br>".join(f"{s.start:.2f} to {s.end:.2f} s ({100 * s.share:.0f} %)" for s in c.spans[:3])
        cells = (
            name,
            f"{factor * c.rms:.3g}",
            f"{factor * c.noise:.3g}",
            times_of(c.rms_over_noise).removesuffix(" times"),
            f"{factor * c.mean:.3g}",
            f"{factor * c.largest:.3g} at {c.largest_at:.2f} s",
        )
        rows.append("<tr>" + _cells(cells) + f"<td class='text'>{spans or 'none'}</td></tr>")
    return f"<table>{''.join(rows)}</table>"


def _cells(texts: Iterable[str]) -> str:
    return "".join(f"<td>{text}</td>" for text in texts)


def _conditions(replay: Replay, comparisons: tuple[Comparison, ...]) -> str:
    """Per joint: share of the time in each condition, and of each signal's squared error (and its growth)."""
    tables = []
    for joint in replay.outcomes:
        of_joint = {pair.key for pair in replay.pairs if pair.joint == joint}
        told = [c for c in comparisons if c.key in of_joint and c.conditions]
        if not told:
            continue
        titles, columns = ["share of the time"], [{q.name: q.of_time for q in told[0].conditions}]
        for c in told:
            titles.append(f"squared error of {c.key}")
            columns.append({q.name: q.of_error for q in c.conditions})
            if c.growing:
                titles.append(f"its growth in {c.key}")
                columns.append({q.name: q.of_error for q in c.growing})
        rows = "".join(
            f"<tr>{_cells([name, *(f'{100 * column[name]:.0f} %' for column in columns)])}</tr>"
            for name in columns[1]
        )
        head = "".join(f"<th class='wide'>{html.escape(title)}</th>" for title in ["condition", *titles])
        tables.append(f"<table><tr>{head}</tr>{rows}</table>")
    return "".join(tables) or "<p class='other'>No condition could be told.</p>"


def _plots(replay: Replay, comparisons: tuple[Comparison, ...]) -> str:
    from plotly.graph_objects import Figure, Scatter
    from plotly.subplots import make_subplots

    stack = panels(replay, comparisons)
    figure: Any = make_subplots(
        rows=len(stack),
        cols=1,
        shared_xaxes=True,
        vertical_spacing=0.25 / (4 * len(stack)),
        row_heights=[panel.height for panel in stack],
        figure=Figure(),
    )
    named: set[str] = set()
    for row, panel in enumerate(stack, start=1):
        for line in panel.lines:
            figure.add_trace(
                Scatter(
                    x=line.time,
                    y=line.values,
                    name=line.name,
                    legendgroup=line.name,
                    showlegend=line.name not in named,
                    line={"color": line.colour, "width": 1.4, "shape": "hv" if line.stepped else "linear"},
                ),
                row=row,
                col=1,
            )
            named.add(line.name)
        for start, end in panel.spans:
            figure.add_vrect(
                x0=start,
                x1=end,
                fillcolor=SPAN_COLOUR,
                opacity=0.3,
                line_width=0,
                layer="below",
                row=row,
                col=1,
            )
        if panel.noise_band:
            figure.add_hrect(
                y0=-panel.noise_band, y1=panel.noise_band, fillcolor=NOISE_COLOUR, opacity=0.3, line_width=0,
                layer="below", row=row, col=1,
            )  # fmt: skip
        figure.update_yaxes(title_text=panel.title.replace(" [", "<br>["), row=row, col=1)
    figure.update_xaxes(title_text="time [s]", row=len(stack), col=1)
    figure.update_yaxes(title_font_size=11, gridcolor="#e4e9ee", zerolinecolor="#c7d0d9")
    figure.update_xaxes(gridcolor="#e4e9ee")
    figure.update_layout(
        height=int(_ROW_PX * sum(panel.height for panel in stack)) + 120,
        plot_bgcolor="white",
        margin={"l": 80, "r": 20, "t": 40, "b": 50},
        legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0},
        hovermode="x unified",
    )
    return str(figure.to_html(full_html=False, include_plotlyjs=True, config={"displaylogo": False}))
