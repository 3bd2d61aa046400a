"""The whole diagnosis: data, fair baseline, search, judgement, place and words."""

import math
import time as clock
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.candidates import Candidate, candidates_of
from hydrolek_drake.diagnosis.conclusion import Conclusion, conclude
from hydrolek_drake.diagnosis.data_quality import reasons_against
from hydrolek_drake.diagnosis.evidence import FINER, Judged, judge
from hydrolek_drake.diagnosis.intervals import Interval, intervals_of
from hydrolek_drake.diagnosis.locate import Location, locate
from hydrolek_drake.diagnosis.score import Score
from hydrolek_drake.diagnosis.search import Search, search
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiment import Experiment, experiments_of
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import Free, free_parameters
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig

BLOCKS = 6
"""Without a held-out recording, each recording is cut into so many blocks ..."""

HELD_BLOCKS = (2, 5)
"""... of which these are held out: one in the middle and the last."""


@dataclass(frozen=True)
class Diagnosis:
    """The outcome.

    Attributes:
        rig: as given.
        verdict: as in `report.json`.
        reasons: why the data are bad, if they are.
        conclusion: what the data say; None for bad data.
        search: all that was tried; None for bad data.
        judged: hypotheses held against held-out data, the most probable first.
        bench: data and fits; None for bad data.
        held_out: data that nothing was fitted to.
        locations: where the mismatch is.
        intervals: full path -> fitted value of the best model.
        seconds: that it took.
    """

    rig: Rig
    verdict: str
    reasons: tuple[str, ...]
    conclusion: Conclusion | None
    search: Search | None
    judged: tuple[Judged, ...]
    bench: Workbench | None
    held_out: tuple[Experiment, ...]
    locations: tuple[Location, ...]
    intervals: dict[str, Interval]
    seconds: float

    @property
    def best(self) -> Judged:
        """The most probable hypothesis."""
        return self.judged[0]

    @property
    def baseline(self) -> Judged:
        """The nominal model, refitted."""
        return next(j for j in self.judged if not j.hypothesis.effects)

    @property
    def step(self) -> float:
        """Integration step of the last fits [s]."""
        assert self.bench is not None
        return FINER * self.bench.fine

    def fitted_rig(self) -> Rig:
        """The rig with the named effects switched on and every parameter estimated anew."""
        return fitted_rig(self.rig, self.best.hypothesis)


def diagnose(
    rig: Rig,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording],
    pool: Executor,
    say: Callable[[str], None] = lambda text: None,
    alive: Callable[[], None] = lambda: None,
) -> Diagnosis:
    """Find out what physics a rig's model leaves out.

    Args:
        rig: the machine's nominal model.
        recordings: what is fitted.
        holdout: what decides; blocks of the recordings are held out if there is none.
        pool: threads for fits side by side.
        say: told what is being done.
        alive: called often; may raise `KeyboardInterrupt`.

    Raises:
        InputError: the recordings lack what the rig needs, or the rig has nothing to fit.
    """
    begun = clock.perf_counter()
    say("looking at the data")
    training, held_out, reasons = _prepared(rig, recordings, holdout)
    if reasons:
        return Diagnosis(
            rig, "bad_data", tuple(reasons), None, None, (), None, (), (), {}, clock.perf_counter() - begun
        )
    nominal = _nominal(rig, training)
    bench = Workbench(rig, nominal, training, pool, alive)
    candidates: list[Candidate] = []
    for joint in dict.fromkeys(experiment.joint for experiment in training):
        candidates += candidates_of(rig, joint, natural_scales(rig, joint, training))
    found = search(bench, candidates, say)
    say("holding the models against data that none of them was fitted to")
    bench.training = tuple(bench.weighted_by(found.best, bench.training))
    held_out = tuple(bench.weighted_by(found.best, held_out))
    judged = tuple(judge(bench, found, held_out))
    conclusion = conclude(judged)
    best = conclusion.best.hypothesis
    return Diagnosis(
        rig=rig,
        verdict=conclusion.verdict,
        reasons=(),
        conclusion=conclusion,
        search=found,
        judged=judged,
        bench=bench,
        held_out=held_out,
        locations=locate(bench, best, found.baseline, bench.training),
        intervals=intervals_of(bench.parameters(best.effects), best.fit),
        seconds=clock.perf_counter() - begun,
    )


def _prepared(
    rig: Rig, recordings: Sequence[Recording], holdout: Sequence[Recording]
) -> tuple[tuple[Experiment, ...], tuple[Experiment, ...], list[str]]:
    """Training data, held-out data, and reasons against them."""
    sets: list[list[Experiment]] = []
    reasons: list[str] = []
    for group in (recordings, holdout):
        experiments: list[Experiment] = []
        for recording in group:
            try:
                own = experiments_of(rig, recording)
            except InputError as error:
                if "constant" not in str(error) and "no value" not in str(error):
                    raise
                reasons.append(str(error))
                continue
            reasons += reasons_against(recording, own)
            experiments += own
        sets.append(experiments)
    training, held_out = sets
    if training and not held_out and not reasons:
        whole = training
        training = [e.split(~_held_blocks(e)) for e in whole]
        held_out = [e.split(_held_blocks(e)) for e in whole]
    return tuple(training), tuple(held_out), reasons


def _held_blocks(experiment: Experiment) -> np.ndarray:
    """Samples of the blocks that are held out. # (n,)."""
    block = np.floor(BLOCKS * np.arange(experiment.time.size) / experiment.time.size)
    return np.isin(block, HELD_BLOCKS)


def _nominal(rig: Rig, training: Sequence[Experiment]) -> tuple[Free, ...]:
    """The rig's free parameters, of the joints that were driven."""
    driven = {experiment.joint for experiment in training}
    free = free_parameters(rig)
    return tuple(p for p in free if not p.path.startswith("joints.") or p.path.split(".")[1] in driven)


def fitted_rig(rig: Rig, hypothesis: Hypothesis) -> Rig:
    """A rig with a hypothesis's values, each with its source."""
    fitted = rig.with_values(hypothesis.values)
    entries = dict(fitted.entries)
    for path in hypothesis.values:
        full = fitted.full_path(path)
        entries[full] = replace(entries[full], source="fitted to recordings by hydrolek diagnose")
    return replace(fitted, entries=entries)


def smallest_visible(diagnosis: Diagnosis) -> list[Score]:
    """Effects that were not found, with the smallest size that would have shown, by id."""
    assert diagnosis.search is not None
    named = {candidate.size_path for candidate in diagnosis.best.hypothesis.effects}
    scores = [s for s in diagnosis.search.left if s.candidate.size_path not in named]
    return sorted(
        (s for s in scores if math.isfinite(s.visible_from) and s.visible_from > 0.0),
        key=lambda s: s.candidate.id,
    )
