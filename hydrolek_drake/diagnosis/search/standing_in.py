"""Numbers of the nominal model that may do what an effect of their stage does: where a fit without the effect begins.

A longer dead time beside a dead time that is fitted is the nominal model with another number. Taken away, the effect
leaves a gap that the fit's slopes do not lead across where other numbers bend sooner. So each number of its stage is
tried at multiples of its value, the others as they are, and the fit begins at the best of them too.
"""

import numpy as np

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.problems import problem_with
from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.rolling import Request, residuals_at


def standing_in(bench: Workbench, without: Entrant, effect: Addition) -> list[Entrant]:
    """A start of a structure without one of its additions; none where no number of its stage leaves less.

    Args:
        bench: data and problems.
        without: the structure without it, where its fit begins.
        effect: that was taken away.
    """
    values = without.values
    stage = (f"joints.{effect.joint}.{effect.stage}.", f"{effect.stage}.")
    numbers = [free for free in bench.nominal if free.path.startswith(stage)]
    tried = [values] + [
        {**values, free.path: float(np.clip(times * values[free.path], free.lower, free.upper))}
        for free in numbers
        for times in FITS.strides
    ]
    problem = problem_with(
        bench, without.effects, bench.step_for(without.effects, FITS.coarse), bench.training
    )
    units = tuple(problem.parameters.unit(each) for each in tried)
    [found] = residuals_at([Request(problem, units)], bench.pool, bench.cores)
    bench.evaluations += problem.evaluations
    squares = [float(residuals @ residuals) for residuals in found]
    best = int(np.argmin(squares))
    return [Entrant(without.effects, tried[best])] if best else []
