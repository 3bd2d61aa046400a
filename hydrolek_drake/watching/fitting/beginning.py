"""Where the nominal model's fit to a recording begins: at the reference's numbers, those that change found first.

Of what changes between recordings only a range is known, and over free rollouts the squares have local minima. So
places that fill these ranges evenly (Sobol, USSR Computational Mathematics 7, 1967, 86) are tried with all other
numbers as the reference has them; the best ones are fitted in the changing numbers alone, and then in all.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.rolling import Request, residuals_at
from hydrolek_drake.watching.fitting.effect_fits import fitted_on
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import BEHIND, CHANGED, CHANGED_KEPT, CHANGED_LOG2, NOMINAL


def nominal_on(session: Session, experiments: Sequence[Experiment], known: Knowledge) -> Place:
    """The nominal model fitted to a recording.

    Args:
        session: rig and reference.
        experiments: of the recording, weighed.
        known: of the machine's own numbers.
    """
    problem = session.problem((), experiments, known)
    every = np.ones(known.mean.size, dtype=bool)
    if not session.changing:
        return fitted_on([Place(problem, every, known.mean)], session, NOMINAL)[0]
    changes = np.array([path in session.changing for path in problem.parameters.paths])
    units = np.tile(known.mean, (2**CHANGED_LOG2, 1))
    units[:, changes] = qmc.Sobol(int(changes.sum()), scramble=False).random_base2(CHANGED_LOG2)
    units = np.clip(units, 1e-6, 1.0 - 1e-6)
    [found] = residuals_at([Request(problem, tuple(units))], session.bench.pool, session.cores)
    squares = [r @ r + np.sum(problem.prior_residuals(u) ** 2) for r, u in zip(found, units, strict=True)]
    best = units[np.argsort(squares)[:CHANGED_KEPT]]
    alone = fitted_on([Place(problem, changes, unit) for unit in best], session, CHANGED, BEHIND)
    begun = [Place(problem, every, place.unit) for place in alone]
    lowest = min(fitted_on(begun, session, CHANGED, BEHIND), key=lambda place: place.objective)
    return fitted_on([replace(lowest, ended=False)], session, CHANGED)[0]
