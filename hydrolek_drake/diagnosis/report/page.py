"""The diagnosis as one HTML file that needs no network: the verdict first, how it was computed last."""

import html
import math
from collections.abc import Collection, Iterable, Sequence

import numpy as np

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.report.as_json import MOST_LISTED, detectable, effects_json, fit_json, models_of
from hydrolek_drake.diagnosis.report.panels import columns, course_panel
from hydrolek_drake.diagnosis.report.words import (
    behind,
    headline,
    off_zero_sentences,
    quantity,
    with_interval,
)
from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.identification.thinning import STEPS
from hydrolek_drake.replay.confirmation import Confirmation
from hydrolek_drake.replay.display import ratio, three_digits
from hydrolek_drake.replay.page import STYLE
from hydrolek_drake.replay.panels import Panel
from hydrolek_drake.replay.plots_html import plots_html
from hydrolek_drake.rigs.rig import declaration

COLOURS = {
    "none": "#2f7d4f",
    "missing_physics": "#b4520b",
    "ambiguous": "#8a6d00",
    "interrupted": "#8a6d00",
    "unlisted_physics": "#8b2c5b",
    "bad_data": "#9b1c1c",
}
_STYLE = """
.verdict { border-left: 6px solid; padding: .6rem 1rem; background: #f7f9fb; margin: 1rem 0 }
.verdict b { font-size: .85rem; letter-spacing: .04em; text-transform: uppercase }
.bar { display: inline-block; height: .75em; background: #1b6ca8; vertical-align: middle }
.wrapped { display: inline-block; max-width: 24em; white-space: normal; text-align: left }
"""


def page(diagnosis: Diagnosis, confirmed: Sequence[Confirmation] = ()) -> str:
    """The whole page.

    Args:
        diagnosis: the outcome.
        confirmed: the fitted rig on the Drake Diagram, where that was run.
    """
    title = f"Diagnosis of {diagnosis.rig.name}"
    colour = COLOURS[diagnosis.verdict]
    parts = [
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
        f"<meta name='viewport' content='width=device-width'><style>{STYLE}{_STYLE}</style></head><body>",
        f"<h1>{html.escape(title)}</h1>",
        f"<div class='verdict' style='border-color:{colour}'><b style='color:{colour}'>"
        f"{diagnosis.verdict.replace('_', ' ')}</b><p class='sentence'>{html.escape(headline(diagnosis))}</p>"
        "</div>",
    ]
    if diagnosis.verdict == "bad_data":
        parts += [
            f"<ul>{''.join(f'<li>{html.escape(r)}</li>' for r in diagnosis.reasons)}</ul></body></html>"
        ]
        return "\n".join(parts)
    pictures = columns(diagnosis)
    if diagnosis.reasons:
        parts.append(f"<ul>{''.join(f'<li>{html.escape(r)}</li>' for r in diagnosis.reasons)}</ul>")
    parts += [
        _effects(diagnosis),
        _fit(diagnosis),
        *(f"<p>{html.escape(each.sentence())}</p>" for each in confirmed),
        "<h2>Measured, before and after</h2>",
        _legend(pictures),
        plots_html(pictures),
        "<h2>Where and when</h2>",
        _locations(diagnosis),
        _unknown(diagnosis),
        "<h2>What was held against the held-out data</h2>",
        _candidates(diagnosis),
        "<h2>Parameters</h2>",
        _parameters(diagnosis),
        "<h2>What these data cannot tell apart</h2>",
        _groups(diagnosis),
        "<h2>What would have been seen</h2>",
        _visible(diagnosis),
        "<h2>Next experiment</h2>",
        f"<p class='other'>{html.escape(_proposed(diagnosis))}</p>",
        "<h2>How it was computed</h2>",
        _method(diagnosis),
        "</body></html>",
    ]
    return "\n".join(parts)


def _proposed(diagnosis: Diagnosis) -> str:
    if diagnosis.proposal is None:
        return "None is needed to decide between effects."
    return f"{diagnosis.proposal.sentence} Its command is in next_experiment.csv."


def _cells(texts: Iterable[str], tag: str = "td", left: Collection[int] = ()) -> str:
    text = " class='text'"
    return "".join(f"<{tag}{text if i in left else ''}>{cell}</{tag}>" for i, cell in enumerate(texts))


def _table(head: Iterable[str], rows: Iterable[Iterable[str]], left: Collection[int] = ()) -> str:
    """A table; the first column and those in `left` are words, the others numbers."""
    body = "".join(f"<tr>{_cells(row, left=left)}</tr>" for row in rows)
    return f"<table><tr>{_cells(head, 'th', left)}</tr>{body}</table>"


def _effects(diagnosis: Diagnosis) -> str:
    told = effects_json(diagnosis)
    zeros = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in off_zero_sentences(diagnosis))
    if not told and not zeros:
        return ""
    rows = "".join(
        f"<li><b>{html.escape(e['id'])}</b> (probability {e['probability']:.2f}): "
        f"{html.escape(e['sentence'])}</li>"
        for e in told
    )
    return f"<ul>{rows}{zeros}</ul>"


def _thinned(diagnosis: Diagnosis) -> str:
    """Which recordings were averaged over blocks, and why."""
    assert diagnosis.bench is not None
    blocks = {e.name: e for e in (*diagnosis.bench.training, *diagnosis.held_out) if e.block > 1}
    if not blocks:
        return ""
    told = {(e.block, round(1e3 * float(np.median(np.diff(e.time))), 3)) for e in blocks.values()}
    sizes = " and ".join(f"{size} samples ({span:g} ms)" for size, span in sorted(told))
    return (
        f"Recordings were sampled far faster than the model is integrated, and averaged over blocks of {sizes}, at "
        f"most {STEPS} integration steps; their noise falls accordingly, and the command keeps its edges. "
    )


def _fit(diagnosis: Diagnosis) -> str:
    fit = fit_json(diagnosis)
    if fit is None:
        return ""
    unit = fit["unit"]
    rows = [
        (name, three_digits(e["train_rms"]), three_digits(e["holdout_rms"]), ratio(e["holdout_over_noise"]))
        for name, e in models_of(diagnosis, fit)
    ]
    head = ("position", f"fitted [{unit}]", f"held out [{unit}]", "all signals held out / noise")
    return (
        _table(head, rows)
        + f"<p class='other'>Noise of the position: {fit['noise_floor']:.3g} {unit} rms.</p>"
    )


def _legend(pictures: Sequence[Sequence[Panel]]) -> str:
    if len(pictures) == 1:
        return "<p class='other'>Shaded: held out, not fitted.</p>"
    if pictures[1][0].spans:
        return (
            "<p class='other'>Left: a recording that was fitted. Right: one of which all but the shaded parts was "
            "fitted too; these were held out.</p>"
        )
    return "<p class='other'>Left: a recording that was fitted. Right: one that was not.</p>"


def _locations(diagnosis: Diagnosis) -> str:
    if not diagnosis.locations:
        return "<p class='other'>Nothing is left over that could be located.</p>"
    rows = [
        (
            place.joint,
            place.stage,
            f"{100 * place.share:.0f} %",
            f"<span class='wrapped'>{html.escape(place.condition)}</span>",
            "<br>".join(f"{a:.2f} to {b:.2f} s" for a, b in place.when[:5]) or "all the time",
        )
        for place in diagnosis.locations
    ]
    return _table(
        ("joint", "stage", "share of the mismatch", "condition", "where it grows most"), rows, (1, 3)
    )


def _unknown(diagnosis: Diagnosis) -> str:
    """What must have entered at each stage for the nominal model to follow the machine."""
    if not diagnosis.estimates:
        return ""
    likeliest = diagnosis.estimates[0]
    rows = [
        (
            html.escape(e.unknown.input.stage),
            html.escape(e.unknown.input.symbol),
            f"{100.0 * e.explained:.0f} %",
            f"{0.5 * (e.evidence - likeliest.evidence):.0f}",
        )
        for e in diagnosis.estimates
    ]
    head = ("stage", "unknown input", "share of the innovations", "log-likelihood less the best")
    return (
        "<p class='other'>An unknown input at each stage in turn, estimated from the innovations of an observer around "
        "the nominal model: what must have entered there for the model to follow the first recording, and how likely "
        "that makes the data. Below the likeliest one, with two standard deviations.</p>"
        + _table(head, rows, (1,))
        + plots_html([[course_panel(likeliest)]])
    )


def _candidates(diagnosis: Diagnosis) -> str:
    listed = [*diagnosis.judged[:MOST_LISTED], *diagnosis.also_tried[:MOST_LISTED]]
    worst = max(j.over_noise for j in listed)
    rows = []
    for judged in listed:
        width = 220.0 * judged.over_noise / worst
        rows.append(
            (
                html.escape(judged.hypothesis.label),
                "given up" if math.isnan(judged.probability) else f"{judged.probability:.3f}",
                ratio(judged.hypothesis.fit.over_noise),
                ratio(judged.over_noise),
                behind(judged),
                f"<span class='bar' style='width:{max(width, 2):.0f}px'></span>",
            )
        )
    told = (
        "<p class='other'>'Given up': so far behind when the data were weighed anew that it was not fitted again.</p>"
        if diagnosis.also_tried
        else ""
    )
    among = (
        "<p class='other'>'Posterior': probability among these models. What is told of an effect is lower, by how "
        "often such names were right on concealed machines, where the truth is known. 'Behind': log-density of the "
        "held-out data less than that of the most probable, with its standard error over blocks of the recordings; "
        "of less than two standard errors these data alone do not tell.</p>"
    )
    return (
        _table(("model", "posterior", "fitted / noise", "held out / noise", "behind", ""), rows, (5,))
        + among
        + told
    )


def _parameters(diagnosis: Diagnosis) -> str:
    rows = []
    for path, known in diagnosis.intervals.items():
        unit = declaration(diagnosis.rig, path).unit
        nominal = diagnosis.rig.value(path)
        short = path.removeprefix(f"joints.{diagnosis.rig.joints[0]}.")
        value, low, high = with_interval(known, unit)
        rows.append((html.escape(short), quantity(nominal, unit), value, f"{low} to {high}"))
    return _table(("parameter", "in the rig", "fitted", "95 % interval"), rows)


def _groups(diagnosis: Diagnosis) -> str:
    groups = diagnosis.conclusion.groups if diagnosis.conclusion else ()
    if not groups:
        return "<p class='other'>No other listed effect explains the held-out data nearly as well.</p>"
    return "<ul>" + "".join(f"<li>{html.escape(' or '.join(g))}</li>" for g in groups) + "</ul>"


def _visible(diagnosis: Diagnosis) -> str:
    rows = [(html.escape(name), html.escape(size)) for name, size in detectable(diagnosis).items()]
    return (
        "<p class='other'>The smallest size at which each effect that was not named would have shown "
        "(four standard deviations):</p>" + _table(("effect", "size"), rows, (1,))
    )


def _intervals(diagnosis: Diagnosis) -> str:
    if not diagnosis.best.hypothesis.effects or diagnosis.law is not None:
        return "Intervals come from the curvature of the last fit. "
    return (
        "The numbers of the model that is named were then fitted until no step promises a tenth of a square, and the "
        "interval of each of its effects' reaches to where the likelihood, all others fitted anew, has fallen by what "
        f"chance lets it fall in {100 * EVIDENCE.confidence:g} % of repetitions. "
    )


def _method(diagnosis: Diagnosis) -> str:
    assert diagnosis.bench is not None and diagnosis.search is not None
    return (
        f"<p class='other'>{_thinned(diagnosis)}The nominal model was refitted first, by bounded least squares "
        "within the rig's ranges. "
        "Every effect that can act on this machine was then held against what was left, alone and, where one was "
        "not enough, together with others; each model was fitted to the training data only. Models are compared "
        "by the likelihood of the held-out data less a cost for every effect and parameter. "
        f"{_intervals(diagnosis)}"
        f"{len(diagnosis.search.hypotheses)} models were fitted to the end, {diagnosis.bench.evaluations} "
        f"simulations of all recordings, last step {1e3 * diagnosis.best.hypothesis.step:.3g} ms, "
        f"{diagnosis.seconds:.0f} s.</p>"
    )
