"""What is no property of the machine but of a recording, fitted to each with the machine's numbers as they are.

Where a disturbance stands in its cycle when a recording begins, and when commands got lost, are such nuisance
parameters.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.fitting.problems import problem_with
from hydrolek_drake.diagnosis.lost_commands.search import windows_held_out
from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.lost_windows import LostWindows, recording_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place


def with_stands(bench: Workbench, judged: Judged, held_out: Sequence[Experiment]) -> Judged:
    """The same, with where its structure stands in each recording: as fitted, but for what is the recording's own.

    What is known of a recording stays: all blocks of it have the same.

    Args:
        bench: data and problems.
        judged: a structure.
        held_out: recordings, or blocks of them.
    """
    h = judged.hypothesis
    stands = dict(judged.stands)
    for part in held_out:
        if recording_of(part) in stands:
            continue
        experiment = part.split(np.ones_like(part.used))  # a lost command moves all that comes after it
        lost = windows_held_out(bench, h, experiment, h.step)
        effects: tuple[Addition, ...] = tuple(
            lost if lost is not None and isinstance(c, LostWindows) else c for c in h.effects
        )
        rest = {path: value for path, value in h.values.items() if ".lost." not in path}
        unit = bench.parameters(effects).unit(rest)
        if phases_of(h).any():
            unit = _in_phase(bench, effects, unit, experiment, h.step)
        stands[recording_of(part)] = effects, unit
    return replace(judged, stands=stands)


def phases_of(hypothesis: Hypothesis) -> np.ndarray:
    """Which parameters say where a periodic law stands when a recording begins. # (n,) truth values."""
    periodic = [c for c in hypothesis.effects if isinstance(c, LawTerm) and c.term is None]
    paths = {path for c in periodic for path in (c.size_path, f"{c.path}.cosine")}
    return np.array([path in paths for path in hypothesis.values])


def own_of_recordings(hypothesis: Hypothesis) -> np.ndarray:
    """Which parameters are no property of the machine: phases, and when commands got lost. # (n,) truth values."""
    lost = np.array([".lost." in path for path in hypothesis.values])
    return phases_of(hypothesis) | lost


def _in_phase(
    bench: Workbench, effects: tuple[Addition, ...], unit: np.ndarray, experiment: Experiment, step: float
) -> np.ndarray:
    """Where a structure with a periodic law stands in a recording, its phase fitted to it. # (n,)."""
    problem = problem_with(bench, effects, step, [experiment])
    paths = list(problem.parameters.paths)
    term = next(c for c in effects if isinstance(c, LawTerm) and c.term is None)
    sine, cosine = paths.index(term.size_path), paths.index(f"{term.path}.cosine")
    moving = np.isin(np.arange(len(paths)), (sine, cosine))
    amplitude = np.hypot(unit[sine] - 0.5, unit[cosine] - 0.5)
    begun = []
    for angle in 2.0 * np.pi * np.arange(EVIDENCE.phases) / EVIDENCE.phases:
        turned = unit.copy()
        turned[sine], turned[cosine] = 0.5 + amplitude * np.cos(angle), 0.5 + amplitude * np.sin(angle)
        begun.append(Place(problem, moving, turned))
    first = sorted(descend(begun, 0, bench.pool, bench.cores), key=lambda place: place.objective)[:2]
    ended = descend(first, 6, bench.pool, bench.cores, stop=bench.alive)
    return min(ended, key=lambda place: place.objective).unit
