"""Windows in which commands got lost, fitted: least squares, and each tried elsewhere, where these do not lead."""

from collections.abc import Mapping

import numpy as np

from hydrolek_drake.diagnosis.lost_commands.problem import LostProblem
from hydrolek_drake.diagnosis.lost_commands.windows import (
    GAIN,
    NONE,
    WINDOW_S,
    Windows,
    in_order,
    joined,
    recording_of,
)
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares import Fit, fit_from

STEPS = 60
"""Trust-region steps of a fit at most: a nominal model without the windows has bent its numbers far, and before they
are back a window of no meaning may do some good."""

REACH_S, APART_S = 1.5 * WINDOW_S, 0.1 * WINDOW_S
"""A window that was fitted is tried elsewhere so far to either side, so far apart ..."""

LENGTHS_S = tuple(WINDOW_S * share for share in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0))
"""... and with its own and these lengths: least squares that begin beside a window of a few milliseconds end there."""


def fitted_windows(
    bench: Workbench,
    problem: LostProblem,
    nominal: np.ndarray,
    fresh: Mapping[str, Windows] | None,
    alone: bool = False,
) -> tuple[Fit, dict[str, Windows]]:
    """The fit, from some nominal parameters on, and windows without which the data would not do.

    Args:
        bench: stops it, and counts.
        problem: with the windows about which they lie.
        nominal: parameters. # (n,)
        fresh: recording -> those of its windows that were not fitted yet, which are tried elsewhere before, and all
            after the fit; None where they are where they belong, but for what a finer step changes.
        alone: leave these as they are.
    """
    moved = fresh is None
    if fresh is not None:
        problem = problem.about(_elsewhere(bench, problem, nominal, dict(problem.begun), fresh))
    while True:
        begun = problem.start(nominal)
        moving = np.arange(begun.size) >= nominal.size if alone else None
        fit = fit_from(
            problem, begun, most_steps=STEPS, tolerance=1e-4, stop=bench.interrupted, moving=moving
        )
        nominal, windows = fit.unit[: nominal.size], problem.windows(fit.unit)
        needed = {name: problem.needed(fit, windows, name) for name in windows}
        bench.evaluations += problem.evaluations
        kept = {name: lost[needed[name]] for name, lost in windows.items()}
        if not all(each.all() for each in needed.values()):
            problem = problem.about(kept)
            continue
        kept = {name: joined(lost) for name, lost in kept.items()}
        elsewhere = kept if moved else _elsewhere(bench, problem, nominal, kept, kept)
        if elsewhere is kept:
            return fit, kept
        problem, moved = problem.about(elsewhere), True


def _elsewhere(
    bench: Workbench,
    problem: LostProblem,
    nominal: np.ndarray,
    windows: dict[str, Windows],
    moving: Mapping[str, Windows],
) -> dict[str, Windows]:
    """Some windows, one after the other, where they leave least with all else as it is; the same if none moves.

    Args:
        bench: rollouts side by side.
        problem: with the recordings.
        nominal: parameters. # (n,)
        windows: all of them.
        moving: recording -> those that are tried elsewhere.
    """
    records = problem.parameters.records(nominal)
    step, latest = problem.longest_step, windows
    assert step is not None
    for experiment in problem.experiments:
        own = recording_of(experiment)
        alone = LostProblem(problem.parameters, [experiment], step, latest, problem.neutral)

        def left(lost: Windows, alone: LostProblem = alone, own: str = own) -> float:
            bench.alive()
            return float(np.sum(alone.left(records, {own: lost}) ** 2))

        for window in moving.get(own, NONE):
            others, (begin, end) = latest[own][(latest[own] != window).any(axis=1)], window
            places = [*tried_about(float(begin), float(end), others), window]
            least = bench.side_by_side(lambda place, o=others: left(in_order(o, place[None])), places)
            best = int(np.argmin(least))
            if least[best] < least[-1] - GAIN * max(least[best] / max(experiment.counted, 1), 1.0):
                latest = {**latest, own: in_order(others, places[best][None])}
        bench.evaluations += alone.evaluations
    return latest


def tried_about(begin: float, end: float, others: Windows) -> list[np.ndarray]:
    """Windows about one that was fitted, which meet no other. # (2,) each.

    Args:
        begin: of the one that was fitted [s].
        end: of it [s].
        others: of the recording [s].
    """
    middles = 0.5 * (begin + end) + np.arange(-REACH_S, REACH_S + 0.5 * APART_S, APART_S)
    lengths = (end - begin, *LENGTHS_S)
    tried = [np.array([middle - 0.5 * each, middle + 0.5 * each]) for middle in middles for each in lengths]
    return [lost for lost in tried if not np.any((others[:, 0] < lost[1]) & (others[:, 1] > lost[0]))]
