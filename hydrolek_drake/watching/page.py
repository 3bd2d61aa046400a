"""The watch as one HTML file that needs no network: the outcome first, a click on a point shows its recording."""

import html
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydrolek_drake.replay.display import ratio
from hydrolek_drake.replay.page import STYLE
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

_STYLE = """
.verdict { border-left: 6px solid; padding: .6rem 1rem; background: #f7f9fb; margin: 1rem 0 }
.verdict b { font-size: .85rem; letter-spacing: .04em; text-transform: uppercase }
#recording { border: 1px solid #d9e0e7; padding: .2rem 1rem 1rem; margin-top: 1rem; min-height: 3rem }
td.what { white-space: normal; max-width: 15em }
td.path { max-width: 24em; overflow: hidden; text-overflow: ellipsis }
tr.beyond td { background: #fdf3ea }
a { color: #1b6ca8 }
"""

_SCRIPT = """
const shown = document.getElementById('recording');
function show(id) {
  const r = RECORDINGS[id];
  if (!r) return;
  shown.innerHTML = '<h2></h2><p class="other"><a></a></p><div id="curves"></div>';
  shown.querySelector('h2').textContent = r.title;
  const link = shown.querySelector('a');
  link.textContent = r.path; link.href = r.link;
  const lines = [
    ['measured', r.curves.measured, 'y', '#222222'], ['command', r.curves.command, 'y2', '#555555'],
    ['nominal model', r.curves.nominal, 'y3', '#1b6ca8'], [r.best, r.curves.best, 'y3', '#8b2c5b']];
  Plotly.newPlot('curves', lines.filter(l => l[1]).map(l => ({x: r.curves.time, y: l[1], name: l[0], yaxis: l[2],
    mode: 'lines', line: {color: l[3], width: 1.3, shape: l[2] == 'y2' ? 'hv' : 'linear'}})), {
    height: 430, plot_bgcolor: 'white', margin: {l: 80, r: 20, t: 10, b: 45}, hovermode: 'x unified',
    legend: {orientation: 'h', y: 1.02, yanchor: 'bottom', x: 0},
    xaxis: {title: {text: 'time [s]'}, gridcolor: '#e4e9ee', anchor: 'y3'},
    yaxis: {title: {text: r.axis, font: {size: 11}}, domain: [0.70, 1], gridcolor: '#e4e9ee'},
    yaxis2: {title: {text: 'command [V]', font: {size: 11}}, domain: [0.42, 0.64], gridcolor: '#e4e9ee'},
    yaxis3: {title: {text: 'left / noise', font: {size: 11}}, domain: [0, 0.36], gridcolor: '#e4e9ee'}},
    {displaylogo: false});
  shown.scrollIntoView({behavior: 'smooth', block: 'nearest'});
}
document.querySelectorAll('.plotly-graph-div').forEach(plot => plot.on('plotly_click', event => {
  const id = event.points[0].customdata;
  if (id) show(id);
}));
document.querySelectorAll('a[data-id]').forEach(a => a.addEventListener('click', e => {
  e.preventDefault();
  show(a.dataset.id);
}));
"""


def page(watched: Watched, limits: Sequence[Limit] = (), folder: Path | None = None) -> str:
    """The whole page.

    Args:
        watched: the outcome.
        limits: that the user set.
        folder: where the page will stand, to which links to recordings are relative.
    """
    from plotly.offline import get_plotlyjs

    title = f"Watch of {watched.rig.name}"
    alarm = watched.alarm is not None
    colour, word = ("#9b1c1c", "alarm") if alarm else ("#2f7d4f", "no alarm")
    parts = [
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
        f"<meta name='viewport' content='width=device-width'><style>{STYLE}{_STYLE}</style>"
        f"<script>{get_plotlyjs()}</script></head><body><h1>{html.escape(title)}</h1>",
        f"<div class='verdict' style='border-color:{colour}'><b style='color:{colour}'>{word}</b>"
        f"<p class='sentence'>{html.escape(headline(watched))}</p></div>",
    ]
    lack = sentence(watched.told, watched.answers)
    if lack:
        parts.append(f"<p class='other'><b>Reference.</b> {html.escape(lack)}</p>")
    if watched.answers:
        for effect, joint in _plotted(watched, limits):
            parts += _effect(watched, effect, joint, limits)
        parts += [
            "<h2>What models leave</h2><p class='other'>Root mean square of the residuals over the noise: what the "
            "nominal model leaves, and what is left with the best single effect. Above the threshold something grows "
            "that is in no list, or more than one thing.</p>",
            _plot(left_figure(watched)),
        ]
    parts += [
        "<div id='recording'><p class='other'>Click a point, or a recording of the table, to see it here.</p></div>",
        "<h2>Every effect, last recording</h2>",
        _last(watched),
        "<h2>Recordings</h2><p class='other'>Evidence: the largest of all effects, of this recording and those before "
        "it, over what an alarm asks for.</p>",
        _recordings(watched),
        _broken(watched),
        "<h2>The rule</h2>",
        _rule(watched),
        f"<script>const RECORDINGS = {_data(watched, folder)};{_SCRIPT}</script></body></html>",
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
        _plot(size_figure(watched, effect, joint, limits)),
    ]


def _plot(figure: Any) -> str:
    return str(figure.to_html(full_html=False, include_plotlyjs=False, config={"displaylogo": False}))


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
        beyond = " class='beyond'" if (told.gain if first else told.beside_gain or 0.0) > limit else ""
        beside = "" if told.beside_gain is None else f"{told.beside_gain:.1f}"
        rows.append(
            f"<tr{beyond}><td>{html.escape(told.effect)}</td>"
            f"<td class='text what'>{html.escape(title_of(told.effect))}</td>"
            f"<td class='what'>{html.escape(size)}</td><td>{told.gain:.1f}</td>"
            f"<td class='what'>{html.escape(beside_text(told))}</td><td>{beside}</td><td>{limit:.1f}</td></tr>"
        )
    head = (
        "<tr><th>effect</th><th class='text'>what</th><th>size alone (95 %)</th><th>gain</th>"
        "<th class='wide'>size beside the first (95 %)</th><th>gain</th><th>threshold</th></tr>"
    )
    return (
        "<p class='other'>Each effect as if it alone explained the difference, and beside the first where that one is "
        "surely there: what imitates it is nothing then, and a second fault is not. Shaded: beyond the threshold.</p>"
        f"<table>{head}{''.join(rows)}</table>"
    )


def _recordings(watched: Watched) -> str:
    head = (
        "<tr><th>time</th><th class='text'>from</th><th class='text'>recording</th><th>left / noise</th>"
        "<th class='text'>best effect</th><th>gain</th><th class='text'>beyond</th>"
        "<th>evidence</th><th class='text'>for</th></tr>"
    )
    rows, evidence = [], watched.evidence
    for each, judgement in zip(watched.asked, watched.judgements, strict=True):
        assert each.answer is not None
        best = each.answer.effects[0]
        beyond = " class='beyond'" if judgement.beyond else ""
        key, share = max(evidence[each.digest].items(), key=lambda item: item[1])
        told = f"{share:.2g}" if share < 100.0 else "over 100"
        rows.append(
            f"<tr{beyond}><td>{each.stamp.iso}</td><td class='text'>{each.stamp.source}</td><td class='text path'>"
            f"<a href='#recording' data-id='{each.digest}'>{html.escape(Path(each.recording).name)}</a></td>"
            f"<td>{ratio(each.answer.left)}</td><td class='text'>{html.escape(best.effect)}</td>"
            f"<td>{best.gain:.1f}</td><td class='text'>{'yes' if judgement.beyond else ''}</td>"
            f"<td>{told}</td><td class='text path'>{html.escape(key)}</td></tr>"
        )
    return f"<table>{head}{''.join(rows)}</table>" if rows else "<p class='other'>None.</p>"


def _broken(watched: Watched) -> str:
    if not watched.broken:
        return ""
    rows = "".join(
        f"<li>{html.escape(each.recording)}: {html.escape(each.problem)}</li>" for each in watched.broken
    )
    return f"<h2>Recordings that could not be asked</h2><ul>{rows}</ul>"


def _rule(watched: Watched) -> str:
    healthy = watched.healthy
    lone = (
        " With one reference recording it is not known how much a healthy machine varies between recordings; the rate "
        "holds only where the model with its stated drift is right."
        if len(watched.reference) < 2
        else " Gains of the reference recordings, each held against the others, are at most "
        f"{ratio(healthy.inflation)} times what chance gives, by which thresholds are raised."
    )
    return (
        f"<p class='other'>The likelihood ratios of recordings with and without an effect add up; the alarm is raised "
        f"where they exceed what leaves a healthy machine's series any alarm with a probability of "
        f"{watched.rule.false_alarms:g} at most. One recording alone is no alarm, and one that tells nothing changes "
        f"nothing. By itself a recording is beyond its threshold where its gain, the fall of the squares against the "
        f"reference, is more than chance brings in all tests of all recordings."
        f"{lone}</p>"
    )


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
