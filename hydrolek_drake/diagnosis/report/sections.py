"""The parts of the page that are words and tables."""

import html
import math
from collections.abc import Collection, Iterable

import numpy as np

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.report.as_json import MOST_LISTED, detectable, effects_json, fit_json, models_of
from hydrolek_drake.diagnosis.report.engineers_units import converted, in_engineers_units
from hydrolek_drake.diagnosis.report.equations import equation_of
from hydrolek_drake.diagnosis.report.look_at import stage_sentences
from hydrolek_drake.diagnosis.report.words import behind, off_zero_sentences, quantity, with_interval
from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.identification.experiments.thinning import STEPS
from hydrolek_drake.replay.display import ratio, three_digits

PROBABILITY = (
    "Probability: how likely it is that this is truly missing, which is the posterior probability among all models "
    "that were tried, times how often names of this kind were right on concealed machines, where the truth is known."
)
"""The one kind of probability that the page has."""


def proposed(diagnosis: Diagnosis) -> str:
    """The next experiment, in a sentence."""
    if diagnosis.proposal is None:
        return "None is needed to decide between effects."
    return f"{diagnosis.proposal.sentence} Its command is in next_experiment.csv."


def table(head: Iterable[str], rows: Iterable[Iterable[str]], left: Collection[int] = ()) -> str:
    """A table whose rows become lists on a narrow screen.

    Args:
        head: of the columns.
        rows: of cells, in HTML.
        left: columns of words beside the first one; the others are numbers.
    """
    titles = list(head)
    text = " class='text'"
    top = "".join(f"<th{text if i in left else ''}>{title}</th>" for i, title in enumerate(titles))
    body = "".join(
        "<tr>"
        + "".join(
            f"<td{text if i in left else ''} data-head='{html.escape(title, quote=True)}'>"
            f"<span>{cell if i else _breakable(cell)}</span></td>"
            for i, (title, cell) in enumerate(zip(titles, row, strict=True))
        )
        + "</tr>"
        for row in rows
    )
    return f"<table><tr class='head'>{top}</tr>{body}</table>"


def _breakable(name: str) -> str:
    """A name that may be broken at its dots and lines."""
    return name.replace(".", ".<wbr>").replace("_", "_<wbr>")


def effects(diagnosis: Diagnosis) -> str:
    """What was found: each effect with its sentence, its equation, its sizes, and what to look at."""
    told = effects_json(diagnosis)
    zeros = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in off_zero_sentences(diagnosis))
    found = {(c.id, c.joint): c for c in (diagnosis.best.hypothesis.listed if diagnosis.conclusion else ())}
    rows = []
    for entry in told:
        candidate = found.get((entry["id"], entry["joint"]))
        more = ""
        if candidate is not None:
            more = equation_of(candidate, diagnosis)
            if candidate.effect.inspect:
                more += f"<p class='look'><b>On the machine:</b> {html.escape(candidate.effect.inspect)}</p>"
        elif diagnosis.law is not None:
            told_law = diagnosis.law.equation().replace(" * ", " · ").replace("2 pi ", "2π ")
            more = f"<p class='equation'>{html.escape(told_law)}</p>" if diagnosis.law.of_the_machine else ""
            look = stage_sentences().get(diagnosis.law.law.input.stage, "")
            more += f"<p class='look'><b>On the machine:</b> {html.escape(look)}</p>" if look else ""
        rows.append(
            f"<li><b>{html.escape(entry['id'])}</b> (probability {entry['probability']:.2f}): "
            f"{html.escape(entry['sentence'])}{more}</li>"
        )
    listed = f"<ul class='effects'>{''.join(rows)}</ul><p class='other'>{PROBABILITY}</p>" if rows else ""
    return listed + (f"<ul>{zeros}</ul>" if zeros else "")


def fit(diagnosis: Diagnosis) -> str:
    """Errors before and with what was found, and the noise."""
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
        table(head, rows)
        + f"<p class='other'>Noise of the position: {fit['noise_floor']:.3g} {unit} rms.</p>"
    )


def locations(diagnosis: Diagnosis) -> str:
    """Where and when the mismatch grows."""
    if not diagnosis.locations:
        return "<p class='other'>Nothing is left over that could be located.</p>"
    rows = [
        (
            place.joint,
            place.stage,
            f"{100 * place.share:.0f} %",
            html.escape(place.condition),
            "<br>".join(f"{a:.2f} to {b:.2f} s" for a, b in place.when[:5]) or "all the time",
        )
        for place in diagnosis.locations
    ]
    return table(
        ("joint", "stage", "share of the mismatch", "condition", "where it grows most"), rows, (1, 3)
    )


def unknown(diagnosis: Diagnosis) -> str:
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
        "that makes the data. Their courses are drawn above, beneath the first recording's command, with two standard "
        "deviations.</p>" + table(head, rows, (1,))
    )


def candidates(diagnosis: Diagnosis) -> str:
    """The models that were compared on the held-out data."""
    listed = [*diagnosis.judged[:MOST_LISTED], *diagnosis.also_tried[:MOST_LISTED]]
    worst = max(j.over_noise for j in listed)
    rows = []
    for judged in listed:
        width = 100.0 * judged.over_noise / worst
        rows.append(
            (
                html.escape(judged.hypothesis.label),
                ratio(judged.hypothesis.fit.over_noise),
                ratio(judged.over_noise),
                "given up" if math.isnan(judged.probability) else behind(judged),
                f"<span class='bar' style='width:{max(width, 1):.0f}%'></span>",
            )
        )
    told = (
        "<p class='other'>'Given up': so far behind when the data were weighed anew that it was not fitted again.</p>"
        if diagnosis.also_tried
        else ""
    )
    among = (
        "<p class='other'>'Behind': by how much the held-out data's log-density is less than with the most probable "
        "model, with its standard error over blocks of the recordings; a question mark where it is less than two of "
        "these, which the held-out data alone do not tell.</p>"
    )
    return table(("model", "fitted / noise", "held out / noise", "behind", ""), rows, (4,)) + among + told


def parameters(diagnosis: Diagnosis) -> str:
    """Every parameter that was fitted."""
    rows = []
    for path, known in diagnosis.intervals.items():
        unit = diagnosis.rig.entries[path].unit
        nominal = diagnosis.rig.value(path)
        short = path.removeprefix(f"joints.{diagnosis.rig.joints[0]}.")
        value, low, high = with_interval(known, unit)
        rows.append(
            (
                html.escape(short),
                quantity(nominal, unit),
                value,
                f"{low} to {high}",
                html.escape(converted(known, unit)),
            )
        )
    return table(("parameter", "in the rig", "fitted", "95 % interval", "in other units"), rows)


def groups(diagnosis: Diagnosis) -> str:
    """Effects that these data cannot tell apart."""
    groups = diagnosis.conclusion.groups if diagnosis.conclusion else ()
    if not groups:
        return "<p class='other'>No other listed effect explains the held-out data nearly as well.</p>"
    return "<ul>" + "".join(f"<li>{html.escape(' or '.join(g))}</li>" for g in groups) + "</ul>"


def visible(diagnosis: Diagnosis) -> str:
    """The smallest sizes that would have shown."""
    told = detectable(diagnosis)
    rows = []
    for each in diagnosis.visible:
        effect, known = each.candidate.effect, Interval(each.size, each.size, each.size)
        size = next(p for p in effect.parameters if p.name == effect.size)
        usual = in_engineers_units(diagnosis.rig, each.candidate, size, known)
        rows.append((html.escape(effect.id), html.escape(told[effect.id]), html.escape(usual)))
    return (
        "<p class='other'>The smallest size at which each effect that was not named would have shown "
        "(four standard deviations):</p>" + table(("effect", "size", "in other units"), rows, (1, 2))
    )


def method(diagnosis: Diagnosis) -> str:
    """How it was computed, in a paragraph."""
    assert diagnosis.bench is not None and diagnosis.search is not None
    return (
        f"<p class='other'>{_thinned(diagnosis)}The nominal model was refitted first, by bounded least squares "
        "within the rig's ranges. "
        "Every effect that can act on this machine was then tried on what was left, alone and, where one was "
        "not enough, together with others; each model was fitted to the training data only. Models are compared "
        "by the likelihood of the held-out data less a cost for every effect and parameter. "
        f"{_intervals(diagnosis)}"
        f"{len(diagnosis.search.hypotheses)} models were fitted to the end, {diagnosis.bench.evaluations} "
        f"simulations of all recordings, last step {1e3 * diagnosis.best.hypothesis.step:.3g} ms, "
        f"{diagnosis.seconds:.0f} s.</p>"
    )


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


def _intervals(diagnosis: Diagnosis) -> str:
    if not diagnosis.best.hypothesis.effects or diagnosis.law is not None:
        return "Intervals come from the curvature of the last fit. "
    return (
        "The parameters of the named model were then fitted until no step would lower the squared residuals, in units "
        f"of the noise, by more than {EVIDENCE.worth:g}. The interval of each effect's parameter reaches to where the "
        "profile likelihood, with all other parameters fitted anew, has fallen by what chance explains in "
        f"{100 * EVIDENCE.confidence:g} % of repetitions. "
    )
