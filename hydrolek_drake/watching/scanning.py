"""What every effect would change of a recording, at a few sizes each, and what the squares say of its size.

The machine's own numbers follow along their tangents: of each change only what lies across the columns of their
Jacobian, the prior's rows included, is left (score test, Rao 1948, with finite differences; see
`diagnosis.fitting.projection`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.settings import LOCATING
from hydrolek_drake.diagnosis.structures.candidates import Candidate, redundant
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.identification.rolling import Request, residuals_at
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.likelihood import Branch
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import MOST_TIMES


@dataclass(frozen=True)
class Scan:
    """One effect at a few sizes.

    Attributes:
        candidate: the effect.
        branches: of each choice of its other parameters and each sign; sizes are strengths, see `strength`.
        gain: squares by which the best place along the branches is lower than without the effect.
        start: full path -> value of its parameters there.
        deviation: of its strength there, by the change at the nearest size that was tried.
    """

    candidate: Candidate
    branches: tuple[Branch, ...]
    gain: float
    start: dict[str, float]
    deviation: float


def strength(candidate: Candidate, size: float) -> float:
    """A size as a number that is zero where the effect is not there: itself, or its inverse where it fades."""
    return 1.0 / size if candidate.weakens else size - candidate.effect.neutral_size


def size_of(candidate: Candidate, strong: float) -> float:
    """The size of a strength; infinite for none of an effect that fades."""
    if candidate.weakens:
        return 1.0 / strong if strong > 0.0 else np.inf
    return strong + candidate.effect.neutral_size


def strengths(candidate: Candidate) -> tuple[float, float]:
    """Least and largest strength that is searched."""
    free = candidate.size
    if candidate.weakens:
        return 0.0, 1.0 / free.lower
    return min(strength(candidate, free.lower), 0.0), strength(candidate, free.upper)


def scanned(
    session: Session,
    place: Place,
    experiments: Sequence[Experiment],
    known: Knowledge,
    beside: tuple[Candidate, ...] = (),
) -> list[Scan]:
    """Every effect beside the nominal model, or beside that with some effects, the most promising first.

    Args:
        session: rig and reference.
        place: of that model on a recording, with residuals and slopes.
        experiments: of the recording, weighed.
        known: of the machine's own numbers.
        beside: effects that the model has.
    """
    bench = session.bench
    fit = fit_of(place)
    object.__setattr__(fit, "slopes", place.slopes)  # those that led are near enough for a tangent
    across = Across(fit)
    values = place.problem.parameters.values(place.unit)
    candidates = [c for c in session.candidates if c not in beside and not redundant(beside, c)]
    tried = {c.size_path: _tried(c) for c in candidates}
    # one step for all: what an effect changes must not be what a shorter step of its own does
    requests = [Request(place.problem.with_step(LOCATING.coarse), (place.unit,))]
    for candidate in candidates:
        with_it = (*beside, candidate)
        problem = session.problem(with_it, experiments, known).with_step(
            LOCATING.coarse * bench.step_for(beside) / bench.step_for(with_it)
        )
        own = problem.parameters
        units = tuple(own.unit({**values, **start}) for start in tried[candidate.size_path])
        requests.append(Request(problem, units))
    (here,), *answers = residuals_at(requests, bench.pool, session.cores)
    left = across(np.concatenate([fit.residuals, fit.off_prior]))
    still = np.zeros_like(fit.off_prior)
    scans = []
    for candidate, found in zip(candidates, answers, strict=True):
        changes = [across(np.concatenate([moved - here, still])) for moved in found]
        scans.append(_scan(candidate, tried[candidate.size_path], changes, left))
    return sorted(scans, key=lambda scan: -scan.gain)


def _tried(candidate: Candidate) -> list[dict[str, float]]:
    """Places of an effect's own parameters that are tried, near those where searches begin and smaller."""
    size, moments = candidate.size_path, {free.path for free in candidate.moments}
    starts = list(candidate.starts)
    for path in moments:
        times = sorted({start[path] for start in starts})
        kept = times[:: max(len(times) // MOST_TIMES, 1)]
        starts = [start for start in starts if start[path] in kept]
    if candidate.sudden or moments:
        return starts
    others: dict[tuple[tuple[str, float], ...], list[float]] = {}
    for start in starts:
        others.setdefault(tuple((p, v) for p, v in start.items() if p != size), []).append(start[size])
    found = []
    for rest, sizes in others.items():
        for sign in (1.0, -1.0):
            own = sorted({abs(s) for s in sizes if s * sign > 0.0})
            if not own:
                continue
            far = own[-1] if candidate.weakens else own[0]  # the faintest
            faint = 10.0 * far if candidate.weakens else 0.1 * far
            free = candidate.size
            own = [s for s in (*own, faint) if free.lower <= sign * s <= free.upper]
            found += [{**dict(rest), size: sign * s} for s in own]
    return found


def _scan(
    candidate: Candidate, starts: list[dict[str, float]], changes: list[np.ndarray], left: np.ndarray
) -> Scan:
    groups: dict[tuple[tuple[tuple[str, float], ...], bool], list[tuple[float, np.ndarray]]] = {}
    for start, change in zip(starts, changes, strict=True):
        strong = strength(candidate, start[candidate.size_path])
        rest = tuple((p, v) for p, v in start.items() if p != candidate.size_path)
        groups.setdefault((rest, strong > 0.0), []).append((strong, change))
    branches, best = [], (0.0, dict(starts[0]), np.inf)
    for (rest, positive), own in groups.items():
        ordered = sorted(own, key=lambda each: abs(each[0]))
        sizes = np.array([0.0, *(strong for strong, _ in ordered)])
        moved = np.stack([np.zeros_like(left), *(change for _, change in ordered)])
        if not np.isfinite(moved).all() or np.abs(moved).max() > 1e6:  # diverged: nothing is known there
            continue
        branch = Branch(sizes, moved @ moved.T, moved @ left)
        branches.append(branch)
        inward = Branch(np.abs(sizes), branch.gram, branch.along)
        sign = 1.0 if positive else -1.0
        places = np.concatenate([np.linspace(0.0, end, 101) for end in inward.sizes[1:]])
        places = np.concatenate([places, np.geomspace(1.0, 10.0, 21) * inward.sizes[-1]])
        lowest, largest = strengths(candidate)
        places = places[sign * places <= largest] if positive else places[-places >= lowest]
        rises = inward.rises(places)
        at = int(np.argmin(rises))
        if -rises[at] > best[0]:
            near = 1 + int(np.argmin(np.abs(inward.sizes[1:] - places[at])))
            deviation = float(inward.sizes[near] / np.sqrt(max(branch.gram[near, near], 1e-300)))
            size = size_of(candidate, sign * float(places[at]))
            best = (-float(rises[at]), {**dict(rest), candidate.size_path: size}, deviation)
    return Scan(candidate, tuple(branches), best[0], best[1], best[2])
