"""The replay as one HTML file that needs no network."""

import html
from collections.abc import Iterable

from hydrolek_drake.replay.comparison import Comparison, times_of
from hydrolek_drake.replay.display import display_factor, display_unit
from hydrolek_drake.replay.panels import NOISE_COLOUR, SPAN_COLOUR, panels
from hydrolek_drake.replay.plots_html import plots_html
from hydrolek_drake.replay.replay import Replay

STYLE = """
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
        f"<style>{STYLE}</style></head><body><h1>{html.escape(title)}</h1>",
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
        plots_html([panels(replay, comparisons)]),
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
    titles = ("signal", "rms", "noise", "times the noise", "mean", "largest")
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
