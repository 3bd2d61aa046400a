"""From data to a verdict: the search, the evidence, and what is told of the best structure."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.evidence.judged import Conclusion, Judged, conclude, with_behind_cut
from hydrolek_drake.diagnosis.evidence.judging import judge_as_fitted, judge_structures
from hydrolek_drake.diagnosis.evidence.reported import left_of
from hydrolek_drake.diagnosis.fitting.parts import cut
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.laws.found import law_of, likeliest_side, lost_of, terms_of
from hydrolek_drake.diagnosis.laws.law import FoundLaw
from hydrolek_drake.diagnosis.locating.terms_for import estimates_for, terms_for
from hydrolek_drake.diagnosis.locating.unknown_input import Estimate
from hydrolek_drake.diagnosis.remarks import (
    ASKED_FOR,
    AT_BEST,
    AT_THE_CUT,
    BY_BOTH,
    INTERRUPTED,
    SIGNALS_APART,
)
from hydrolek_drake.diagnosis.search.from_the_cut import search_machine
from hydrolek_drake.diagnosis.settings import EVIDENCE, NOISE
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.lost_windows import LostWindows, lost_in
from hydrolek_drake.diagnosis.structures.splitting import halves, mixed
from hydrolek_drake.diagnosis.structures.weighing import far_over_noise, weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiments.experiment import Experiment


@dataclass(frozen=True)
class Known:
    """What one search and its judgement gave.

    Attributes:
        bench: data and problems.
        found: all that was tried.
        held_out: data that nothing was fitted to, weighted by the best structure.
        judged: structures compared on them, the most probable first.
        conclusion: what both say.
        interrupted: whether the search was ended by the user.
    """

    bench: Workbench
    found: Tried
    held_out: tuple[Experiment, ...]
    judged: tuple[Judged, ...]
    conclusion: Conclusion
    interrupted: bool


@dataclass(frozen=True)
class Answer:
    """What is told.

    Attributes:
        known: the search that counts, and its judgement.
        conclusion: what the data say.
        law: for physics in no list, the law found for it, if one was.
        remarks: how it came about, for the report.
        estimates: courses of unknown inputs around the nominal model, the likeliest first, where they were asked for.
    """

    known: Known
    conclusion: Conclusion
    law: FoundLaw | None = None
    remarks: tuple[str, ...] = ()
    estimates: tuple[Estimate, ...] = ()


@dataclass(frozen=True)
class Inquiry:
    """What is asked of one set of recordings.

    Attributes:
        candidates: every effect that may be missing.
        scales: natural scales of the driven joints at which there may be a law.
        apart: whether the held-out data are of another kind, not blocks among the rest.
        say: told what is being done.
    """

    candidates: Sequence[Candidate]
    scales: Mapping[str, Scales]
    apart: bool
    say: Callable[[str], None]

    def answer(self, bench: Workbench, held_out: Sequence[Experiment]) -> Answer:
        """Search and judge; an interrupt ends it with what is known by then.

        Args:
            bench: data and problems.
            held_out: data that nothing is fitted to: of every other block structures are chosen, the rest reports.

        Raises:
            KeyboardInterrupt: before the nominal model was fitted.
        """
        bench.training, held_out = cut(bench, bench.training), cut(bench, held_out)
        chosen, kept = halves(held_out)
        known, found = self._known(bench, chosen, Tried())
        remarks: tuple[str, ...] = ()
        astray, far = self.apart and _astray(known), _far_in_all(known)
        if not known.interrupted and (astray or far):
            # numbers that the training data do not tell, the held-out ones ask for
            training = known.bench.training
            if astray:
                training, chosen, kept = mixed(training, held_out)
                remarks = (BY_BOTH,)
            again = known.bench.with_training(training, signals_apart=far)
            known, found = self._known(again, chosen, Tried(seeds=found.near_the_best(bench.settings)))
            if far and (told := _told_apart(known.bench)):
                remarks = (*remarks, SIGNALS_APART.format(told=told))
        best = likeliest_side(known.judged).hypothesis
        known = self._reported(known, kept)
        first = known.judged[0]
        if first.fitted_too is not None:
            left = first.left_behind_cut
            predicted = first.over_noise if left is None else left
            remarks = (*remarks, ASKED_FOR.format(predicted=predicted, fitted=first.fitted_too))
        elif first.left_behind_cut is not None and not known.interrupted:
            uncut = _uncut_over_noise(known)
            remarks = (*remarks, AT_THE_CUT.format(behind=first.left_behind_cut, uncut=uncut))
        conclusion, law = self._told(known, next(j for j in known.judged if j.hypothesis is best))
        if conclusion.verdict != "unlisted_physics" and first.granted:
            left, trained = first.left_behind_cut, first.trained_behind_cut
            told = AT_BEST.format(
                left=first.over_noise if left is None else left,
                trained=first.hypothesis.fit.over_noise if trained is None else trained,
                share=100.0 * known.bench.rig.value("integration.model_error"),
                least=first.least_held_out,
            )
            remarks = (*remarks, told)
        if known.interrupted:
            remarks = (*remarks, INTERRUPTED)
            conclusion = replace(conclusion, verdict="interrupted")
        estimates: tuple[Estimate, ...] = ()
        if (
            not known.interrupted
            and len(self.scales) == 1
            and known.found.baseline.fit.over_noise > NOISE.above
        ):
            self.say("estimating what enters at each stage")
            [(joint, scales)] = self.scales.items()
            estimates = estimates_for(known.bench, known.found.baseline, joint, scales)
        return Answer(replace(known, conclusion=conclusion), conclusion, law, remarks, estimates)

    def _known(self, bench: Workbench, held_out: Sequence[Experiment], found: Tried) -> tuple[Known, Tried]:
        """The search and its judgement."""
        interrupted = False

        try:
            search_machine(
                bench,
                self.candidates,
                found,
                self.say,
                _Unlisted(self.scales) if self.scales else None,
            )
        except KeyboardInterrupt:
            if not found.hypotheses:
                raise
            interrupted = True
            bench.resume()
        self.say("comparing the models on held-out data")
        weighted = tuple(held_out)
        try:
            bench.training = tuple(weighted_by(bench, found.best, bench.training))
            weighted = tuple(weighted_by(bench, found.best, held_out))
            judged = judge_structures(bench, found, weighted)
        except KeyboardInterrupt:
            interrupted = True
            bench.resume()
            judged = judge_as_fitted(bench, list(found.hypotheses.values()), weighted)
        known = Known(bench, found, weighted, tuple(judged), conclude(judged), interrupted)
        return known, found

    def _reported(self, known: Known, kept: Sequence[Experiment]) -> Known:
        """The same with what structures leave of data by which none was chosen, which have the verdict's last word."""
        try:
            weighted = tuple(weighted_by(known.bench, known.judged[0].hypothesis, kept))
            judged = left_of(known.bench, known.judged, weighted)
        except KeyboardInterrupt:
            return replace(known, interrupted=True)
        return replace(known, held_out=weighted, judged=judged, conclusion=conclude(judged))

    def _told(self, known: Known, best: Judged) -> tuple[Conclusion, FoundLaw | None]:
        """The conclusion, and the law of the best structure, if it has one."""
        terms = terms_of(best.hypothesis)
        if lost_in(best.hypothesis.effects) is not None:
            lost = lost_of(known.bench, best, known.held_out)
            told = replace(known.conclusion, verdict="unlisted_physics", best=_beside(known, best), groups=())
            return told, lost
        if not terms:
            return known.conclusion, None
        stages = {terms[0].input.stage}
        rivals = []
        for other in known.judged:
            theirs = terms_of(other.hypothesis)
            possible = other.probability > EVIDENCE.significance or other is known.judged[0]
            if theirs and possible and theirs[0].input.stage not in stages:
                stages.add(theirs[0].input.stage)
                rivals.append(theirs[0].input.stage)
        law = law_of(known.bench, best, known.held_out, rivals)
        named = _beside(known, best)
        groups = (tuple(f"unlisted.{s}" for s in (terms[0].input.stage, *rivals)),) if rivals else ()
        return replace(known.conclusion, verdict="unlisted_physics", best=named, groups=groups), law


@dataclass(frozen=True)
class _Unlisted:
    """Physics in no list; see `best_first.Unlisted`."""

    scales: Mapping[str, Scales]

    def offer(self, bench: Workbench, parent: Hypothesis) -> Sequence[LawTerm | LostWindows]:
        return terms_for(bench, parent, self.scales)


def _beside(known: Known, best: Judged) -> Judged:
    """The structure that has the best one's effects and no law, which the report tells the law beside."""
    effects = frozenset(c.size_path for c in best.hypothesis.effects if isinstance(c, Candidate))
    for judged in known.judged:
        if judged.hypothesis.ids == effects:
            return judged
    return next(j for j in known.judged if not j.hypothesis.effects)


def _uncut_over_noise(known: Known) -> float:
    """Times the noise that the best structure leaves of the held-out data where the supply's own pressure acts."""
    best, bench = known.judged[0].hypothesis, known.bench
    whole = [e.uncut() for e in known.held_out]
    residuals = bench.residuals(best, whole, bench.step_for(best.effects))
    return math.sqrt(float(residuals @ residuals) / max(sum(e.counted for e in whole), 1))


def _astray(known: Known) -> bool:
    """Whether the best structure leaves more of the held-out data than the training data lead one to expect.

    That is as much, to what noise is known to; where it does not explain these, what it leaves is its own discrepancy,
    which differs between movements by more. What a pump's line does is not told for long
    (`Judged.explains_held_out`), but what lies behind its recorded pressure is.
    """
    best = with_behind_cut(known.judged[0], known.bench.training, known.held_out)
    left, predicted = best.hypothesis.fit.over_noise, best.over_noise
    if best.trained_behind_cut is not None and best.left_behind_cut is not None:
        left, predicted = best.trained_behind_cut, best.left_behind_cut
        if not best.explains_held_out:
            return True
    return predicted > max(left, 1.0) * (
        NOISE.held_out if left <= NOISE.held_out else NOISE.explained_held_out
    )


def _far_in_all(known: Known) -> bool:
    """Whether the best structure is far from the noise of several signals, and of each of them."""
    residuals = known.judged[0].hypothesis.fit.residuals
    begin = 0
    squares: dict[str, list[np.ndarray]] = {}
    limit = far_over_noise(known.bench.training)
    for experiment in known.bench.training:
        for channel in experiment.channels:
            own = residuals[begin : begin + experiment.time.size]
            counts = experiment.used & np.isfinite(channel.measured)
            squares.setdefault(channel.key, []).append(own[counts] ** 2)
            begin += experiment.time.size
    return len(squares) > 1 and all(np.concatenate(s).mean() > limit**2 for s in squares.values())


def _told_apart(bench: Workbench) -> str:
    """Discrepancies of signals in words; nothing where there are none."""
    shares = {c.key: c.discrepancy for e in bench.training for c in e.channels}
    apart = any(share != 1.0 for share in shares.values())
    return (
        ", ".join(f"{key} {share:.3g} times" for key, share in shares.items() if share > 1.0) if apart else ""
    )
