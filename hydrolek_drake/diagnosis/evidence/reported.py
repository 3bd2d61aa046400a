"""What structures leave of data by which none was chosen: the figures of the report."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.evidence.fitted_to_both import beyond, fitted_to_both, to_both
from hydrolek_drake.diagnosis.evidence.judged import Judged, with_behind_cut, with_differences
from hydrolek_drake.diagnosis.evidence.nuisance import own_of_recordings, with_stands
from hydrolek_drake.diagnosis.fitting.behind_cut import fitted_behind
from hydrolek_drake.diagnosis.fitting.line_search import lowest_along_each
from hydrolek_drake.diagnosis.fitting.problems import problem_with
from hydrolek_drake.diagnosis.structures.lost_windows import recording_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.rolling import Request, residuals_at


def left_of(bench: Workbench, judged: Sequence[Judged], held_out: Sequence[Experiment]) -> tuple[Judged, ...]:
    """The same structures with what they leave of other data than those by which they were judged.

    Where the best one explains what it was fitted to and fails here, these data may show what the others do not, such
    as a place where the joint had not been: then it is fitted to them too, since a model that explains all that was
    recorded lacks nothing that these data could show. What the training data do not tell may lie far off, so that the
    fit goes on from the lowest place along each of its numbers.

    Args:
        bench: data and problems.
        judged: structures, the most probable first.
        held_out: data that nothing was fitted to, and by which nothing was chosen.
    """
    judged = [with_stands(bench, j, held_out) for j in judged]
    requests = []
    for own in judged:
        for experiment in held_out:
            effects, unit = own.stands[recording_of(experiment)]
            requests.append(
                Request(
                    problem_with(
                        bench, effects, bench.step_for(effects, bench.settings.last.coarse), [experiment]
                    ),
                    (unit,),
                )
            )
    answers = iter(residuals_at(requests, bench.pool, bench.cores))
    counted = sum(experiment.counted for experiment in held_out)
    told = tuple(
        replace(
            j,
            held_out=np.concatenate([next(answers)[0] for _ in held_out]),
            held_out_counted=counted,
            chi_squared=None,
            shares=None,
        )
        for j in judged
    )
    told = with_differences(told, held_out)
    told = (with_behind_cut(told[0], bench.training, held_out), *told[1:])
    if not told[0].fails_held_out_alone or own_of_recordings(told[0].hypothesis).any():
        return told
    asked, best, ahead = bench, told[0].hypothesis, list(held_out)
    behind = fitted_behind(bench, best)
    if behind is not None:
        (asked, best), ahead = behind, [e.behind_cut() for e in held_out]
    counted = max(sum(e.counted for e in ahead), 1)
    begun = to_both(asked, best, ahead)
    [both] = fitted_to_both(asked, [begun], renewing=True)
    now = replace(told[0], fitted_too=math.sqrt(beyond(both, best) / counted))
    if now.fails_held_out_alone:
        elsewhere = lowest_along_each(both, asked.pool, asked.cores)
        [both] = fitted_to_both(asked, [elsewhere], renewing=True)
        now = replace(told[0], fitted_too=math.sqrt(beyond(both, best) / counted))
    return (now, *told[1:])
