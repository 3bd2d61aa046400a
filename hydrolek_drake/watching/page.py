"""The watch as one HTML file that needs no network: the outcome first, a click on a point shows its recording."""

import html
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from hydrolek_drake.replay.display import ratio
from hydrolek_drake.replay.plotly_page import figure_html, packed_plotly
from hydrolek_drake.watching.alarms import is_effect
from hydrolek_drake.watching.asking import OWN_NUMBERS, Answer
from hydrolek_drake.watching.excitation import sentence
from hydrolek_drake.watching.figures import left_figure, size_figure
from hydrolek_drake.watching.limits import Limit
from hydrolek_drake.watching.store import Seen
from hydrolek_drake.watching.watch import Watched
from hydrolek_drake.watching.words import (
    beside_text,
    growth_sentence,
    headline,
    latest,
    limit_sentence,
    size_text,
    title_of,
)

SHOWN = 2
"""So many effects have a plot where nothing is alarmed: those with limits, and those with the largest gains."""

_EFFECT_HEAD = (
    ("effect", "text"),
    ("what", "text"),
    ("size alone (95 %)", "what"),
    ("gain", ""),
    ("size beside the first (95 %)", "what"),
    ("gain beside the first", ""),
    ("threshold", ""),
)
_RECORDING_HEAD = (
    ("time", "text name"),
    ("from", "text"),
    ("recording", "text name"),
    ("times the noise", ""),
    ("best effect", "text"),
    ("gain", ""),
    ("beyond", "text"),
    ("evidence", ""),
    ("for", "text"),
)


def page(watched: Watched, limits: Sequence[Limit] = (), folder: Path | None = None) -> str:
    """The whole page.

    Args:
        watched: the outcome.
        limits: that the user set.
        folder: where the page will stand, to which links to recordings are relative.
    """
    title = f"Watch of {watched.rig.name}"
    alarm = watched.alarm is not None
    colour, word = ("alarm", "alarm") if alarm else ("healthy", "no alarm")
    parts = [
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
        f"<meta name='viewport' content='width=device-width, initial-scale=1'><style>{_asset('watch.css')}</style>"
        f"</head><body><h1>{html.escape(title)}</h1>",
        f"<div class='verdict' style='--verdict: var(--{colour})'><b>{word}</b>"
        f"<p class='sentence'>{html.escape(headline(watched))}</p></div>",
    ]
    lack = sentence(watched.told, watched.answers)
    if lack:
        parts.append(f"<div class='warned'><p class='other'>{html.escape(lack)}</p></div>")
    if watched.answers:
        for effect, joint in _plotted(watched, limits):
            parts += _effect(watched, effect, joint, limits)
        parts += [
            "<h2>What models leave</h2><p class='other'>Root mean square of the residuals over the noise: what the "
            "nominal model leaves, and what is left with the best single effect. Above the threshold something grows "
            "that is in no list, or more than one thing.</p>",
            figure_html(left_figure(watched), "what models leave over time"),
        ]
    parts += [
        "<div id='recording'><p class='other'>Click a point, or a recording of the table, to see it here.</p></div>",
        "<h2>Every effect, last recording</h2>",
        _last(watched),
        "<h2>Recordings</h2><p class='other'>Evidence: the largest of all effects, of this recording and those before "
        "it, over what an alarm asks for, and for which effect.</p>",
        _recordings(watched),
        _broken(watched),
        "<h2>The rule</h2>",
        _rule(watched),
        packed_plotly(),
        f"<script>const RECORDINGS = {_data(watched, folder)};{_asset('watch.js')}</script></body></html>",
    ]
    return "\n".join(parts)


def _plotted(watched: Watched, limits: Sequence[Limit]) -> list[tuple[str, str]]:
    """Effects with a plot of their own."""
    joints: dict[tuple[str, str], float] = {}
    for answer in watched.answers:
        for told in answer.effects:
            if told.effect != OWN_NUMBERS:
                key = (told.effect, told.joint)
                joints[key] = joints.get(key, 0.0) + told.gain
    first = [key for key in joints if watched.alarm and key == (watched.alarm.effect, watched.alarm.joint)]
    limited = [key for key in joints if any(limit.effect == key[0] for limit in limits)]
    as_well = [key for key in joints if watched.alarm and key[0] in watched.alarm.as_well]
    chosen = list(dict.fromkeys([*first, *as_well, *limited]))
    if first:  # what others show then is that they imitate it
        return chosen
    rest = sorted(joints, key=lambda key: -joints[key])
    return list(dict.fromkeys([*chosen, *rest]))[: max(SHOWN, len(chosen))]


def _effect(watched: Watched, effect: str, joint: str, limits: Sequence[Limit]) -> list[str]:
    trend, last = watched.trend(effect, joint), latest(watched, effect, joint)
    assert last is not None
    own = [limit for limit in limits if limit.effect == effect]
    told = [growth_sentence(trend, last.unit), *(limit_sentence(limit, trend, last.unit) for limit in own)]
    return [
        f"<h2>{html.escape(effect)}, {html.escape(joint)}: {html.escape(size_text(last))}</h2>",
        f"<p class='other'>{html.escape(' '.join(told))}</p>",
        figure_html(size_figure(watched, effect, joint, limits), f"size of {effect} over time"),
    ]


def _last(watched: Watched) -> str:
    if not watched.answers:
        return "<p class='other'>None.</p>"
    answer, judgement = watched.answers[-1], watched.judgements[-1]
    rows = []
    second = any(told.beside_gain is not None for told in answer.effects)
    for told in answer.effects:
        key = f"{told.joint}.{told.effect}" if told.joint else told.effect
        size = f"{told.size:.3g} of a range" if told.effect == OWN_NUMBERS else size_text(told)
        limit = judgement.thresholds[key]
        first = told is answer.effects[0] or not second
        beyond = (told.gain if first else told.beside_gain or 0.0) > limit
        beside = "" if told.beside_gain is None else f"{told.beside_gain:.1f}"
        gain, what = f"{told.gain:.1f}", title_of(told.effect)
        cells = (told.effect, what, size, gain, beside_text(told), beside, f"{limit:.1f}")
        rows.append(_row(cells, _EFFECT_HEAD, beyond))
    return (
        "<p class='other'>Each effect as if it alone explained the difference, and beside the first where that one is "
        "surely there: what imitates it is nothing then, and a second fault is not. Shaded: beyond the threshold.</p>"
        f"<table>{_head(_EFFECT_HEAD)}{''.join(rows)}</table>"
    )


def _recordings(watched: Watched) -> str:
    rows, evidence = [], watched.evidence
    for each, judgement in zip(watched.asked, watched.judgements, strict=True):
        assert each.answer is not None
        best = each.answer.effects[0]
        key, share = _most(evidence[each.digest])
        told = f"{share:.2g}" if share < 100.0 else "over 100"
        name = html.escape(Path(each.recording).name)
        cells = (
            each.stamp.iso,
            each.stamp.source,
            _Markup(f"<a href='#recording' data-id='{each.digest}'>{name}</a>"),
            ratio(each.answer.left),
            best.effect,
            f"{best.gain:.1f}",
            "yes" if judgement.beyond else "",
            told,
            key,
        )
        rows.append(_row(cells, _RECORDING_HEAD, bool(judgement.beyond)))
    return f"<table>{_head(_RECORDING_HEAD)}{''.join(rows)}</table>" if rows else "<p class='other'>None.</p>"


def _most(shares: Mapping[str, float]) -> tuple[str, float]:
    """For what there is most evidence; of what is beyond an alarm's, effects before what is no effect."""
    named = {key: share for key, share in shares.items() if share > 1.0 and is_effect(key)}
    return max((named or shares).items(), key=lambda item: item[1])


class _Markup(str):
    """A cell that is HTML already."""


def _head(columns: Sequence[tuple[str, str]]) -> str:
    cells = "".join(f"<th class='{kind}'>{name}</th>" for name, kind in columns)
    return f"<tr class='head'>{cells}</tr>"


def _row(cells: Iterable[str], columns: Sequence[tuple[str, str]], beyond: bool) -> str:
    """A row of a table; on a phone each cell stands in a line of its own, with the column's name."""
    told = "".join(
        f"<td class='{kind}' data-head='{name}'>{cell if isinstance(cell, _Markup) else html.escape(cell)}</td>"
        for cell, (name, kind) in zip(cells, columns, strict=True)
    )
    return f"<tr{' class=beyond' if beyond else ''}>{told}</tr>"


def _broken(watched: Watched) -> str:
    if not watched.broken:
        return ""
    rows = "".join(
        f"<li>{html.escape(each.recording)}: {html.escape(each.problem)}</li>" for each in watched.broken
    )
    return f"<h2>Recordings that could not be evaluated</h2><ul>{rows}</ul>"


def _rule(watched: Watched) -> str:
    healthy = watched.healthy
    lone = (
        " With one reference recording it is not known how much a healthy machine varies between recordings; the rate "
        "holds only where the model with its stated drift is right."
        if len(watched.reference) < 2
        else " Gains of the reference recordings, each compared with a fit to the others, are at most "
        f"{ratio(healthy.inflation)} times what chance gives, by which thresholds are raised."
    )
    return (
        f"<p class='other'>The log-likelihood ratios of the recordings with and without an effect are added up. The "
        f"threshold is set so that the whole series of a healthy machine raises any alarm with a probability of at "
        f"most {watched.rule.false_alarms:g}. One recording alone raises no alarm, and one that tells nothing changes "
        f"nothing. A single recording is marked as beyond its threshold where its gain, by which it lowers the squared "
        f"residuals against the reference, is more than chance brings in all tests of all recordings."
        f"{lone}</p>"
    )


def _asset(name: str) -> str:
    return (files(__package__) / "assets" / name).read_text(encoding="utf-8")


def _data(watched: Watched, folder: Path | None) -> str:
    """What a click shows, as JSON that cannot end the script."""
    content = {}
    for each in (*watched.reference, *watched.asked):
        if each.answer is not None:
            content[each.digest] = _shown(each, each.answer, folder)
    return json.dumps(content, allow_nan=False).replace("</", "<\\/")


def _shown(each: Seen, answer: Answer, folder: Path | None) -> dict[str, Any]:
    path = Path(each.recording).absolute()
    try:
        link = path.as_uri() if folder is None else Path(os.path.relpath(path, folder.absolute())).as_posix()
    except ValueError:
        link = path.as_uri()
    return {
        "title": f"{Path(each.recording).name}, {each.stamp.iso} (time from {each.stamp.source})",
        "path": each.recording,
        "link": link,
        "axis": answer.axis,
        "best": f"with {answer.effects[0].effect}",
        "curves": answer.curves,
    }
