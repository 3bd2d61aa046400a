"""An effect held at one size beside the machine's own numbers, which follow it with the slopes that there are.

Their steps are those of the chord method, with slopes that are corrected by how residuals changed (Broyden; see
`identification.least_squares.acceptance`): a rollout each.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.acceptance import Ending, Trial, after
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.normal_equations import NormalEquations
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.rolling import Request, residuals_at
from hydrolek_drake.watching.fitting.scanning import Scan, at_size, size_of
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import (
    DAMPED,
    FURTHER_OUT,
    HELD,
    HOPELESS,
    NEGLIGIBLE,
    SHORTER,
    WORTH,
)


@dataclass(frozen=True)
class Rung:
    """An effect held at one size.

    Attributes:
        candidate: the effect.
        strong: its size, as a strength.
        place: of the model with it, its own numbers fitted; `slopes` are those that led there.
    """

    candidate: Candidate
    strong: float
    place: Place

    @property
    def promised(self) -> float:
        """Squares that are left where own numbers go as far as slopes promise, less what was tried in vain."""
        plan = NormalEquations(self.place)
        return self.place.objective - max(plan.promises(plan.step(DAMPED * self.place.damping)), 0.0)


def hopeless(gain: float, most: float, scale: float) -> bool:
    """Whether an effect imitates another one at most.

    Args:
        gain: squares that it gains, or promises.
        most: squares that the other one gains.
        scale: squares that count as one.
    """
    return most >= max(HOPELESS * scale, FURTHER_OUT * gain)


def held(
    session: Session,
    nominal: Place,
    scan: Scan,
    strong: float,
    experiments: Sequence[Experiment],
    known: Knowledge,
) -> Rung:
    """An effect held at a size, own numbers where their tangents make the most of what it changes.

    Args:
        session: rig and reference.
        nominal: the model without any, fitted, with slopes.
        scan: of the effect.
        strong: the size, as a strength.
        experiments: of the recording.
        known: of the machine's own numbers.
    """
    candidate, count = scan.candidate, nominal.unit.size
    assert nominal.slopes is not None and scan.slope is not None
    problem = session.problem((candidate,), experiments, known)
    own = at_size(candidate, scan.start, size_of(candidate, strong))
    values = {**nominal.problem.parameters.values(nominal.unit), **own}
    unit = np.clip(problem.parameters.unit(values), 1e-6, 1.0 - 1e-6)
    prior = nominal.problem.prior_jacobian()
    square = nominal.slopes.T @ nominal.slopes + prior.T @ prior
    free = np.flatnonzero(np.diag(square) > 0.0)
    pull = nominal.slopes.T @ scan.slope * strong
    way = np.zeros(count)
    way[free] = -np.linalg.lstsq(square[np.ix_(free, free)], pull[free], rcond=None)[0]
    unit[:count] = np.clip(nominal.unit + way, 1e-6, 1.0 - 1e-6)
    slopes = np.zeros((len(nominal.slopes), unit.size))
    slopes[:, :count] = nominal.slopes
    moving = np.arange(unit.size) < count
    return Rung(candidate, strong, Place(problem, moving, unit, slopes=slopes))


def led_on(session: Session, rungs: Sequence[Rung], most: float = np.inf) -> list[Rung]:
    """Own numbers fitted on, with the slopes that there are; each keeps those it began with.

    Args:
        session: rig and reference.
        rungs: where they stand.
        most: squares that none which is likely has.
    """
    places = followed(session, [rung.place for rung in rungs], most)
    return [
        replace(rung, place=replace(place, slopes=rung.place.slopes, fresh=False, ended=False))
        for rung, place in zip(rungs, places, strict=True)
    ]


def followed(session: Session, begun: Sequence[Place], most: float = np.inf) -> list[Place]:
    """Places after a few steps with the slopes that there are, a rollout each; a step that fails is damped.

    Args:
        session: rig and reference.
        begun: where they stand.
        most: squares that none which is likely has: one that promises no less ends.
    """
    pool, cores = session.bench.pool, session.cores
    places = descend(begun, 0, pool, cores)
    for _ in range(HELD):
        ahead = min((place.objective for place in places), default=0.0)
        trials: list[tuple[int, np.ndarray, float]] = []
        for i, place in enumerate(places):
            if place.ended or place.slopes is None:
                continue
            plan = NormalEquations(place)
            way = plan.step(DAMPED * place.damping)
            promised = plan.promises(way)
            least = max(WORTH, NEGLIGIBLE * (place.objective - ahead))
            if promised > least and place.objective - promised < most:
                trials.append((i, way, promised))
        requests = [Request(places[i].problem, (places[i].unit + way,)) for i, way, _ in trials]
        answers = residuals_at(requests, pool, cores)
        for (i, way, promised), (residuals,) in zip(trials, answers, strict=True):
            place = places[i]
            trial = Trial(way, place.damping, promised, residuals)
            there = after(place, [trial], Ending(WORTH))
            failed = there.objective >= place.objective
            places[i] = replace(place, damping=SHORTER * place.damping) if failed else there
    return places
