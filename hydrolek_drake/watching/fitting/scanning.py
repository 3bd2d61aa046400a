"""What every effect would change of a recording, at a few sizes each, and what the squares say of its size.

The machine's own numbers follow along their tangents: of each change only what lies across the columns of their
Jacobian, the prior's rows included, is left (score test, Rao 1948, with finite differences; see
`diagnosis.fitting.projection`). Where own numbers can make nearly all of a large change, what is left of it is how much
they bend, not what the effect leaves. So an effect that changes much at the least of the sizes is tried at one, too,
at which all that it changes is as much as one standard deviation of a number, and told by its slope there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.settings import LOCATING
from hydrolek_drake.diagnosis.structures.candidates import Candidate, redundant
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.acceptance import DIVERGED
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.identification.rolling import Request, residuals_at
from hydrolek_drake.watching.fitting.likelihood import Branch
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import BENT, FAINT, MOST_SUDDEN, MOST_TIMES


@dataclass(frozen=True)
class Scan:
    """One effect at a few sizes.

    Attributes:
        candidate: the effect.
        branches: of each choice of its other parameters and each sign; sizes are strengths, see `strength`.
        gain: squares by which the best place along the branches is lower than without the effect.
        start: full path -> value of its parameters there.
        deviation: of its strength there, by the change at the nearest size that was tried.
        slope: change of the residuals a unit of strength, by that size; None where nothing is known. # (values,)
        tried: that size, as a strength.
    """

    candidate: Candidate
    branches: tuple[Branch, ...]
    gain: float
    start: dict[str, float]
    deviation: float
    slope: np.ndarray | None = None
    tried: float = 0.0


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
    if beside:  # what is left there is small: the least of each size is near enough
        tried = {
            c.size_path: own if c.sudden else _least(c, own)
            for c, own in zip(candidates, tried.values(), strict=True)
        }
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
    changes = {
        c.size_path: [moved - here for moved in own] for c, own in zip(candidates, answers, strict=True)
    }
    faint = {c.size_path: _faint(c, tried[c.size_path], changes[c.size_path]) for c in candidates}
    requests = [
        Request(request.problem, tuple(request.problem.parameters.unit({**values, **s}) for s in starts))
        for request, starts in zip(requests[1:], faint.values(), strict=True)
    ]
    for path, found in zip(faint, residuals_at(requests, bench.pool, session.cores), strict=True):
        tried[path] = [*tried[path], *faint[path]]
        changes[path] += [moved - here for moved in found]
    still = np.zeros_like(fit.off_prior)
    scans = []
    for candidate in candidates:
        path = candidate.size_path
        apart = [across(np.concatenate([change, still])) for change in changes[path]]
        scans.append(_scan(candidate, tried[path], changes[path], apart, left))
    return sorted(scans, key=lambda scan: -scan.gain)


def _tried(candidate: Candidate) -> list[dict[str, float]]:
    """Places of an effect's own parameters that are tried, near those where searches begin and smaller."""
    size, moments = candidate.size_path, {free.path for free in candidate.moments}
    starts = list(candidate.starts)
    for path in moments:
        times = sorted({start[path] for start in starts})
        kept = times[:: max(len(times) // MOST_TIMES, 1)]
        starts = [start for start in starts if start[path] in kept]
    if candidate.sudden:
        return starts[:: max(len(starts) // MOST_SUDDEN, 1)]
    if moments:
        return starts
    found = []
    for own in _groups(candidate, starts).values():
        ordered = sorted(own, key=lambda i: abs(starts[i][size]))
        far = ordered[-1] if candidate.weakens else ordered[0]  # the faintest
        faint = (10.0 if candidate.weakens else 0.1) * starts[far][size]
        found += [starts[i] for i in ordered]
        if candidate.size.lower <= faint <= candidate.size.upper:
            found.append(at_size(candidate, starts[far], faint))
    return found


def _least(candidate: Candidate, starts: list[dict[str, float]]) -> list[dict[str, float]]:
    """Of the places that differ by their size alone, the least."""
    size = candidate.size_path
    groups = _groups(candidate, starts).values()
    return [starts[min(own, key=lambda i: abs(strength(candidate, starts[i][size])))] for own in groups]


def _faint(
    candidate: Candidate, starts: list[dict[str, float]], changes: list[np.ndarray]
) -> list[dict[str, float]]:
    """Places of an effect where it changes about as much as one standard deviation of a number, if all change more."""
    if candidate.sudden:
        return []
    size, found = candidate.size_path, []
    for own in _groups(candidate, starts).values():
        least = min(own, key=lambda i: abs(strength(candidate, starts[i][size])))
        change = float(np.linalg.norm(changes[least]))
        if np.isfinite(change) and change > FAINT:
            strong = strength(candidate, starts[least][size]) / change
            found.append(at_size(candidate, starts[least], size_of(candidate, strong)))
    return found


def at_size(candidate: Candidate, values: Mapping[str, float], size: float) -> dict[str, float]:
    """An effect's values at another size: what it has of the size's unit, as a friction's other force, goes with it.

    Args:
        candidate: the effect.
        values: full path -> value of its parameters.
        size: wanted.
    """
    times = size / values[candidate.size_path]
    along = _amplitudes(candidate)
    return {
        p: size if p == candidate.size_path else v * times if p in along else v for p, v in values.items()
    }


def _amplitudes(candidate: Candidate) -> frozenset[str]:
    """Paths of the parameters that have the unit of its size and go with it."""
    if candidate.weakens or candidate.effect.neutral_size != 0.0:
        return frozenset()
    units = {p.name: p.unit for p in candidate.effect.parameters}
    own = units[candidate.effect.size]
    alike = {f.path for f in candidate.free if units[f.path.rpartition(".")[2]] == own}
    return frozenset(alike - {f.path for f in candidate.moments} - {candidate.size_path})


def _groups(
    candidate: Candidate, starts: Sequence[Mapping[str, float]]
) -> dict[tuple[tuple[tuple[str, float], ...], bool], list[int]]:
    """Places that differ by their size alone, of one sign: (other parameters, whether it is positive) -> numbers."""
    groups: dict[tuple[tuple[tuple[str, float], ...], bool], list[int]] = {}
    for i, start in enumerate(starts):
        one = at_size(candidate, start, 1.0) if _amplitudes(candidate) else start
        rest = tuple((p, float(f"{v:.6g}")) for p, v in one.items() if p != candidate.size_path)
        groups.setdefault((rest, strength(candidate, start[candidate.size_path]) > 0.0), []).append(i)
    return groups


def _scan(
    candidate: Candidate,
    starts: list[dict[str, float]],
    changes: list[np.ndarray],
    apart: list[np.ndarray],
    left: np.ndarray,
) -> Scan:
    """One effect by what it changes at its places, and by the part of that which lies across own numbers."""
    found = Scan(candidate, (), 0.0, dict(starts[0]), np.inf)
    branches: list[Branch] = []
    for (_, positive), own in _groups(candidate, starts).items():
        strong = {i: strength(candidate, starts[i][candidate.size_path]) for i in own}
        # of what diverged nothing is known
        known = [i for i in own if np.isfinite(apart[i]).all() and np.abs(apart[i]).max() < DIVERGED]
        known.sort(key=lambda i: abs(strong[i]))
        if not known:
            continue
        first = np.linalg.norm(apart[known[0]]) / abs(strong[known[0]])
        if not candidate.sudden and any(
            np.linalg.norm(apart[i]) > BENT * first * abs(strong[i]) for i in known[1:2]
        ):
            known = known[:1]
        sizes = np.array([0.0, *(strong[i] for i in known)])
        moved = np.stack([np.zeros_like(left), *(apart[i] for i in known)])
        branch = Branch(sizes, moved @ moved.T, moved @ left)
        branches.append(branch)
        at, gain = _best(candidate, branch, positive)
        if found.slope is not None and gain <= found.gain:
            continue
        near = int(np.argmin(np.abs(sizes[1:] - at)))
        tried = float(sizes[near + 1])
        deviation = abs(tried) / float(np.sqrt(max(branch.gram[near + 1, near + 1], 1e-300)))
        start = at_size(candidate, starts[known[near]], size_of(candidate, at))
        found = Scan(candidate, (), gain, start, deviation, changes[known[near]] / tried, tried)
    return replace(found, branches=tuple(branches))


def _best(candidate: Candidate, branch: Branch, positive: bool) -> tuple[float, float]:
    """The likeliest strength along a branch that is not nothing, and by how much the squares fall there."""
    sizes, sign = np.abs(branch.sizes), 1.0 if positive else -1.0
    least, most = strengths(candidate)
    most = most if positive else -least
    inward = Branch(sizes, branch.gram, branch.along)
    places = np.concatenate([np.linspace(0.0, end, 101)[1:] for end in sizes[1:]])
    places = np.concatenate([places, np.geomspace(1.0, 10.0, 21) * sizes[-1]])
    if sizes.size == 2 and branch.gram[1, 1] > 0.0:  # a slope alone: the squares are a parabola
        places = np.append(places, -sizes[1] * branch.along[1] / branch.gram[1, 1])
    places = places[(places > 0.0) & (places <= most)]
    if not places.size:
        return sign * min(sizes[1], most), 0.0
    rises = inward.rises(places)
    at = int(np.argmin(rises))
    return sign * float(places[at]), max(-float(rises[at]), 0.0)
