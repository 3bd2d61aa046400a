"""The longest steps that lead fits: so many times the rig's own that rollouts in them do not run away."""

from collections.abc import Mapping

import numpy as np

from hydrolek_drake.diagnosis.fitting.problems import problem_with
from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.workbench import Workbench


def no_longer_than_borne(
    bench: Workbench, effects: tuple[Addition, ...], values: Mapping[str, float]
) -> None:
    """Halve the steps that lead fits until rollouts of a structure in them do not run away, or they are the rig's own.

    Where they run away no slope leads anywhere, and nothing that is added shows.

    Args:
        bench: data and problems; its `coarsest` is lowered.
        effects: of the structure.
        values: full path -> where it stands.
    """
    if bench.coarsest <= 1.0:
        return
    unit = bench.parameters(effects).unit(values)

    def left(coarse: float) -> float:
        bench.evaluations += 1
        problem = problem_with(bench, effects, bench.step_for(effects, coarse), bench.training)
        return float(np.linalg.norm(problem.residuals(unit)))

    borne = FITS.runs_away * left(1.0)
    while bench.coarsest > 1.0 and left(bench.coarsest) > borne:
        bench.coarsest = max(0.5 * bench.coarsest, 1.0)
