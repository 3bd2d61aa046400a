"""What differs in one recording: the nominal model with the reference as prior, and beside it one fit per effect."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hydrolek_drake.diagnosis.report.words import unit_at
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.cost import gain_needed
from hydrolek_drake.diagnosis.structures.weighing import weighted_by
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import with_slopes
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether
from hydrolek_drake.replay.display import display_unit
from hydrolek_drake.watching.common_error import shares_of_reference, strength_by_reference
from hydrolek_drake.watching.curves import curves_of
from hydrolek_drake.watching.excitation import told_alone
from hydrolek_drake.watching.fitting.around import around
from hydrolek_drake.watching.fitting.beginning import nominal_on
from hydrolek_drake.watching.fitting.effect_fits import (
    behind_of,
    by_observers,
    fits_of_effects,
    fitted_on,
    rivals,
    with_own_slopes,
    without_effects,
)
from hydrolek_drake.watching.fitting.likelihood import SizeTold, of_branches
from hydrolek_drake.watching.fitting.profiles import profile_of, rungs_of, without
from hydrolek_drake.watching.fitting.rungs import Rung
from hydrolek_drake.watching.fitting.scanning import Scan, scanned, size_of, strengths
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import BEGUN, BEHIND, HOPELESS

OWN_NUMBERS = "machine.own_numbers"
"""Stands for: no effect, but the machine's own numbers changed by more than they were said to drift."""


@dataclass(frozen=True)
class EffectTold:
    """What a recording says of one effect beside the nominal model.

    Attributes:
        effect: its id, or `OWN_NUMBERS`.
        joint: where it acts.
        size: the likeliest (SI).
        low: lower end of the 95 % interval.
        high: upper end.
        unit: of these.
        gain: fall of the squares, residuals' and prior's, in units of what the reference leaves.
        parameters: that the effect adds to the model.
        left: times the noise that the model with it leaves.
        others: name -> value of its other parameters.
        beside_size: the likeliest size beside the effect that gains most, where that one is surely there; else None.
        beside_low: lower end of its 95 % interval.
        beside_high: upper end.
        beside_gain: squares by which it gains there.
        strengths: sizes at which it was held, as strengths (`scanning.strength`), see `likelihood.Profile`.
        rises: squares there less those without it, in units of what the reference leaves.
        shared: standard deviation of its strength by the reference's error, the same in all later recordings.
        shared_shares: of the machine's own numbers, how much of their gain that error makes (`common_error`).
    """

    effect: str
    joint: str
    size: float
    low: float
    high: float
    unit: str
    gain: float
    parameters: int
    left: float
    others: dict[str, float]
    beside_size: float | None = None
    beside_low: float | None = None
    beside_high: float | None = None
    beside_gain: float | None = None
    strengths: tuple[float, ...] = ()
    rises: tuple[float, ...] = ()
    shared: float = 0.0
    shared_shares: tuple[float, ...] = ()


@dataclass(frozen=True)
class Answer:
    """What one recording says.

    Attributes:
        effects: every effect, the largest gain first.
        own: full path -> the machine's own number, fitted with the reference as prior (SI).
        left: times the noise that the nominal model leaves.
        counted: values that count.
        needed: gain below which an effect is not told from what every model leaves out.
        curves: name -> values of what is drawn: time, measured, and residuals over the noise. # (k,) each
        axis: what `measured` is, with the unit in which people read it.
        told_alone: full path -> standard deviation of the machine's own number by this recording alone, in ranges.
        seconds: length of the recording.
    """

    effects: tuple[EffectTold, ...]
    own: dict[str, float]
    left: float
    counted: int
    needed: float
    curves: dict[str, list[float]]
    axis: str = ""
    told_alone: dict[str, float] = field(default_factory=dict)
    seconds: float = 0.0


def asked(session: Session, experiments: Sequence[Experiment], known: Knowledge | None = None) -> Answer:
    """Ask one recording.

    Args:
        session: rig and reference.
        experiments: of the recording.
        known: of the machine's own numbers; None for what all the reference tells.
    """
    bench, cores = session.bench, session.cores
    knowledge = known or session.knowledge
    weighted = weighted_by(bench, session.hypothesis, experiments)
    nominal = nominal_on(session, weighted, knowledge)
    scale = session.posterior.scale
    for left in reversed(range(BEGUN)):
        [nominal] = with_slopes([nominal], bench.pool, cores)
        scans = scanned(session, nominal, weighted, knowledge)
        none = without(session, nominal, [scan.candidate for scan in scans])
        rungs = rungs_of(session, nominal, scans, none, weighted, knowledge)
        fitted = fits_of_effects(session, nominal, scans, rungs, weighted, knowledge)
        lower = without_effects(session, nominal, fitted, scale)
        if lower is None:
            led = by_observers(session, nominal, fitted, scans, weighted, knowledge)
            fitted |= led
            lower = without_effects(session, nominal, led, scale)
        if lower is None or not left:
            break
        nominal = lower
    candidates = {scan.candidate.size_path: scan.candidate for scan in scans}
    near = rivals(session, fitted)
    fitted |= with_own_slopes(session, {path: fitted[path] for path in near}, nominal.unit.size)
    fitted, held = around(session, fitted, candidates, near)
    for path, own_rungs in held.items():
        rungs[path] = [*rungs[path], *own_rungs]
    told = [
        _told(scan, rungs[path], fitted.get(path), nominal, none[path], session, knowledge)
        for scan in scans
        if (path := scan.candidate.size_path)
    ]
    ranked = sorted(told, key=lambda each: -each.gain)
    own = _own_numbers(session, nominal, weighted, knowledge, ranked[0].gain * scale if ranked else 0.0)
    best = fitted.get(_path(session, ranked[0])) if ranked else None
    fit = fit_of(nominal)
    if best is not None and ranked[0].gain > gain_needed(fit):
        ranked = _with_beside(session, ranked, best, weighted, knowledge)
    return Answer(
        effects=(*ranked, own),
        own=nominal.problem.parameters.values(nominal.unit),
        left=fit.over_noise,
        counted=fit.counted,
        needed=gain_needed(fit),
        curves=curves_of(weighted[0], fit, None if best is None else fit_of(best)),
        axis=f"{weighted[0].channels[0].key} [{display_unit(weighted[0].channels[0].unit)}]",
        told_alone=_told_alone(nominal, scale),
        seconds=float(weighted[0].time[-1] - weighted[0].time[0]),
    )


def _with_beside(
    session: Session,
    ranked: list[EffectTold],
    best: Place,
    experiments: Sequence[Experiment],
    known: Knowledge,
) -> list[EffectTold]:
    """The same, each with its size beside the first: what imitates that one is nothing there, a second fault is not."""
    path, scale = _path(session, ranked[0]), session.posterior.scale
    first = next(c for c in session.candidates if c.size_path == path)
    scans = {
        (s.candidate.id, s.candidate.joint): s for s in scanned(session, best, experiments, known, (first,))
    }
    told = []
    for each in ranked:
        scan = scans.get((each.effect, each.joint))
        if scan is None or not scan.branches:
            told.append(each)
            continue
        size, low, high = _sizes(
            scan.candidate, of_branches(list(scan.branches), *strengths(scan.candidate), scale)
        )
        told.append(
            replace(each, beside_size=size, beside_low=low, beside_high=high, beside_gain=scan.gain / scale)
        )
    return told


def _sizes(candidate: Candidate, known: SizeTold) -> tuple[float, float, float]:
    """Size with the ends of its interval, of strengths."""
    low, high = sorted(size_of(candidate, strong) for strong in (known.low, known.high))
    return size_of(candidate, known.size), low, high


def _path(session: Session, told: EffectTold) -> str:
    return next(c.size_path for c in session.candidates if (c.id, c.joint) == (told.effect, told.joint))


def _told(
    scan: Scan,
    rungs: Sequence[Rung],
    fitted: Place | None,
    nominal: Place,
    none: float,
    session: Session,
    knowledge: Knowledge,
) -> EffectTold:
    candidate, scale = scan.candidate, session.posterior.scale
    unit = next(p.unit for p in candidate.effect.parameters if p.name == candidate.effect.size)
    free = [f.path for f in candidate.free]
    profile = profile_of(scan, rungs, none, scale)
    known = profile.told(*strengths(candidate))
    if fitted is None:
        values, left = {path: scan.start[path] for path in free}, fit_of(nominal).over_noise
    else:
        values, left = fitted.problem.parameters.values(fitted.unit), fit_of(fitted).over_noise
    size, low, high = _sizes(candidate, known)
    others = {p.rpartition(".")[2]: values[p] for p in free if p != candidate.size_path}
    return EffectTold(
        effect=candidate.id,
        joint=candidate.joint,
        size=size,
        low=low,
        high=high,
        unit=unit_at(session.rig, candidate, unit),
        gain=0.0 - profile.least,
        parameters=len(candidate.free),
        left=left,
        others=others,
        strengths=profile.sizes,
        rises=profile.rises,
        shared=_shared(scan, nominal, session, knowledge),
    )


def _told_alone(nominal: Place, scale: float) -> dict[str, float]:
    """How surely the recording by itself tells the machine's own numbers."""
    assert nominal.slopes is not None
    return told_alone(nominal.problem.parameters.paths, nominal.slopes, scale)


def _shared(scan: Scan, nominal: Place, session: Session, knowledge: Knowledge) -> float:
    """Standard deviation of an effect's strength by the reference's error."""
    if scan.slope is None or nominal.slopes is None or not np.isfinite(scan.slope).all():
        return 0.0
    return strength_by_reference(nominal.slopes, scan.slope, knowledge.information, session.shared)


def _own_numbers(
    session: Session, nominal: Place, experiments: Sequence[Experiment], known: Knowledge, most: float
) -> EffectTold:
    """The machine's own numbers fitted anew within the rig's ranges, without the reference as prior.

    Args:
        session: rig and reference.
        nominal: the model without any effect, fitted, with slopes.
        experiments: of the recording, weighed.
        known: of the machine's own numbers.
        most: squares that the best effect gains: own numbers that lead nowhere near need not be known to one.
    """
    scale = session.posterior.scale
    behind = behind_of(session, BEHIND) if most > HOPELESS * scale else 0.0
    kind = ProblemTogether if any(e.others is not None for e in experiments) else Problem
    problem = session.bench.problem((), session.bench.fine, experiments, kind=kind)
    assert nominal.slopes is not None
    free = replace(nominal, problem=problem, ended=False, exact=False, residuals=None)
    [place] = fitted_on([replace(free, slopes=nominal.slopes)], session, behind=behind)
    assert place.residuals is not None
    gain = max(nominal.objective - float(place.residuals @ place.residuals), 0.0) / scale
    moved = np.abs(place.unit - session.posterior.mean)
    return EffectTold(
        effect=OWN_NUMBERS,
        joint="",
        size=float(moved.max()),
        low=np.nan,
        high=np.nan,
        unit="1",
        gain=gain,
        parameters=place.unit.size,
        left=fit_of(place).over_noise,
        others=problem.parameters.values(place.unit),
        shared_shares=shares_of_reference(nominal.slopes, known.information, session.shared),
    )
