"""The whole diagnosis: data, search, judgement, place and numbers."""

import os
import time as clock
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

from threadpoolctl import threadpool_limits

from hydrolek_drake.diagnosis.evidence.judged import Conclusion, Judged
from hydrolek_drake.diagnosis.evidence.judging import judge_given_up
from hydrolek_drake.diagnosis.evidence.proposal import Proposal, propose
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.inquiry import Inquiry
from hydrolek_drake.diagnosis.intervals.curvature import Interval, intervals_of
from hydrolek_drake.diagnosis.intervals.last_numbers import intervals_of_moments, with_last_numbers
from hydrolek_drake.diagnosis.intervals.visible import Visible, visible_sizes
from hydrolek_drake.diagnosis.laws.enlarged_rig import enlarged_rig
from hydrolek_drake.diagnosis.laws.law import FoundLaw
from hydrolek_drake.diagnosis.laws.located import locate_law
from hydrolek_drake.diagnosis.locating.place import Location, locate
from hydrolek_drake.diagnosis.locating.unknown_input import Estimate
from hydrolek_drake.diagnosis.progress import Progress
from hydrolek_drake.diagnosis.remarks import INTERRUPTED
from hydrolek_drake.diagnosis.settings import FITS, NOISE
from hydrolek_drake.diagnosis.structures.as_rig import room_for_law
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.splitting import prepared
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import Free, free_of_joints
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig


@dataclass(frozen=True)
class Diagnosis:
    """The outcome.

    Attributes:
        rig: as given.
        verdict: as in `report.json`.
        reasons: why the data are bad, if they are; or that the search was interrupted.
        conclusion: what the data say; None for bad data.
        search: all that was tried; None for bad data.
        judged: hypotheses compared on held-out data, the most probable first.
        also_tried: hypotheses that were not fitted to the end, the best first.
        bench: data and fits; None for bad data.
        held_out: data that nothing was fitted to.
        locations: where the mismatch is.
        intervals: full path -> fitted value of the best model, with a law fitted beside that.
        law: for physics in no list, the law found for it, if one was.
        proposal: the experiment that would decide, if one is needed.
        visible: smallest sizes of effects that would have been seen beside the best model, by id.
        seconds: that it took.
        estimates: courses of unknown inputs around the nominal model, the likeliest first, where they were asked for.
    """

    rig: Rig
    verdict: str
    reasons: tuple[str, ...]
    conclusion: Conclusion | None
    search: Tried | None
    judged: tuple[Judged, ...]
    also_tried: tuple[Judged, ...]
    bench: Workbench | None
    held_out: tuple[Experiment, ...]
    locations: tuple[Location, ...]
    intervals: dict[str, Interval]
    law: FoundLaw | None
    proposal: Proposal | None
    visible: tuple[Visible, ...]
    seconds: float
    estimates: tuple[Estimate, ...] = ()

    @property
    def best(self) -> Judged:
        """The hypothesis that is named."""
        return self.conclusion.best if self.conclusion else self.judged[0]

    @property
    def baseline(self) -> Judged:
        """The nominal model, refitted."""
        return next(j for j in self.judged if not j.hypothesis.effects)

    @property
    def step(self) -> float:
        """Integration step of the last fits [s]."""
        assert self.bench is not None
        return self.bench.step_for(self.best.hypothesis.effects, FITS.last_step)

    def fitted_rig(self) -> Rig:
        """The rig with the named effects and the law switched on and every parameter estimated anew."""
        assert self.bench is not None
        return enlarged_rig(self.rig, self.best.hypothesis, self.law)


def diagnose(
    rig: Rig,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording],
    pool: Executor,
    say: Callable[[str], None] = lambda text: None,
    between: tuple[float, float] | None = None,
    cores: int = os.cpu_count() or 1,
    more: Callable[[str], None] = lambda text: None,
) -> Diagnosis:
    """Find out what physics a rig's model leaves out.

    Args:
        rig: the machine's nominal model.
        recordings: what is fitted.
        holdout: what decides; blocks of the recordings are held out if there is none.
        pool: threads for fits side by side.
        say: told what is being done.
        between: start and end of the part of the recordings that is fitted [s]; what lies outside is held out if
            there is no `holdout`. None for all.
        cores: that roll out at the same time.
        more: told how the fits stand, once a round: what is tried, what is best so far, how long it may take.

    An interrupt during the search ends it; what is known by then is judged and returned with a reason.

    Raises:
        InputError: the recordings lack what the rig needs, or the rig has nothing to fit.
        KeyboardInterrupt: before the nominal model was fitted.
    """
    # fits run side by side already: threads of the linear algebra under each of them only wait for each other
    with threadpool_limits(limits=1, user_api="blas"):
        return _diagnosed(rig, recordings, holdout, pool, say, between, cores, more)


def _diagnosed(
    rig: Rig,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording],
    pool: Executor,
    say: Callable[[str], None],
    between: tuple[float, float] | None,
    cores: int,
    more: Callable[[str], None],
) -> Diagnosis:
    """See `diagnose`."""
    begun = clock.perf_counter()
    say("looking at the data")
    training, held_out, reasons = prepared(rig, recordings, holdout, between)
    if reasons:
        return _refused(rig, reasons, clock.perf_counter() - begun)
    nominal = _nominal(rig, training)
    bench = Workbench(rig, nominal, training, pool, cores, Progress(more))
    joints = tuple(dict.fromkeys(experiment.joint for experiment in training))
    scales = {joint: natural_scales(rig, joint, training) for joint in joints}
    candidates = list(
        {c.size_path: c for joint in joints for c in candidates_of(rig, joint, scales[joint])}.values()
    )
    lawful = {
        joint: scales[joint] for joint in joints if room_for_law(rig, joint, bench.settings.most_additions)
    }
    apart = bool(holdout) or between is not None
    answer = Inquiry(candidates, lawful, apart, say).answer(bench, held_out)
    known, conclusion, law, remarks = answer.known, answer.conclusion, answer.law, answer.remarks
    bench, held_out, found, judged = known.bench, known.held_out, known.found, known.judged
    best = conclusion.best.hypothesis
    if law is not None:
        parameters = bench.parameters(best.effects)
        records = parameters.records(parameters.unit(law.parameters))
        law = law.held_against(held_out, records, bench.step_for(best.effects, FITS.last_step))
    places: tuple[Location, ...] = ()
    proposal: Proposal | None = None
    visible: tuple[Visible, ...] = ()
    intervals: dict[str, Interval] = {}
    try:
        # where more than noise is left, what every model leaves out bends numbers by more than the last squares tell
        if best.effects and law is None and best.fit.over_noise <= NOISE.explained:
            say("refining the fitted parameters")
            last, intervals, held_out = with_last_numbers(bench, conclusion.best, held_out)
            judged = tuple(last if j is conclusion.best else j for j in judged)
            conclusion, best = replace(conclusion, best=last), last.hypothesis
        say("locating what was found, and what would have been seen")
        # uncut, since a position shows what the supply lacks only where its own pressure acts
        places = locate(bench, best, found.baseline, tuple(e.uncut() for e in bench.training))
        if law is not None:
            places = (locate_law(bench, best, found.baseline, law), *places)
        proposal = propose(bench, conclusion, [j.hypothesis for j in judged])
        visible = visible_sizes(bench, best, found.left)
    except KeyboardInterrupt:  # the verdict stands without what is left
        bench.resume()
        remarks = (*remarks, INTERRUPTED)
    if not intervals:
        intervals = intervals_of(bench.parameters(best.effects), bench.without_jumps(best).fit)
    return Diagnosis(
        rig=rig,
        verdict=conclusion.verdict,
        reasons=remarks,
        conclusion=conclusion,
        search=found,
        judged=judged,
        also_tried=tuple(judge_given_up(bench, found, held_out)),
        bench=bench,
        held_out=held_out,
        locations=places,
        intervals={
            **intervals,
            **(law.intervals if law is not None else {}),
            **intervals_of_moments(bench, best),
        },
        law=law,
        proposal=proposal,
        visible=visible,
        seconds=clock.perf_counter() - begun,
        estimates=answer.estimates,
    )


def _refused(rig: Rig, reasons: Sequence[str], seconds: float) -> Diagnosis:
    """What is left to say about data that cannot be diagnosed."""
    return Diagnosis(
        rig=rig,
        verdict="bad_data",
        reasons=tuple(reasons),
        conclusion=None,
        search=None,
        judged=(),
        also_tried=(),
        bench=None,
        held_out=(),
        locations=(),
        intervals={},
        law=None,
        proposal=None,
        visible=(),
        seconds=seconds,
    )


def _nominal(rig: Rig, training: Sequence[Experiment]) -> tuple[Free, ...]:
    """The rig's free parameters, of the joints that were driven; effects that are off are searched, not nominal."""
    return free_of_joints(rig, {experiment.joint for experiment in training})
