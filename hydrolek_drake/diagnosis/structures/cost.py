"""What a structure costs, and what a further addition must bring before it is believed."""

import math

from hydrolek_drake.diagnosis.settings import GAINS, NOISE
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis
from hydrolek_drake.identification.least_squares.least_squares import Fit


def cost(structure: Hypothesis) -> float:
    """Twice the negative log-likelihood of the training data, and what its additions and their parameters cost."""
    additions = sum(c.cost for c in structure.effects)
    return misfit(structure.fit) + gain_needed(structure.fit) * additions + 2.0 * structure.extra


def misfit(fit: Fit) -> float:
    """Twice the negative log-likelihood of what a fit leaves, with the discrepancy of its model as a parameter.

    A model that is right leaves squares as many as there are values, n; one that leaves s n has a discrepancy, whose
    variance, as large as it is most likely, makes that n (1 + log s) (profile likelihood). What takes a share of a
    misfit then counts by that share, and near the noise by its squares.
    """
    share = fit.objective / max(fit.counted, 1)
    return fit.counted * (1.0 + math.log(share)) if share > 1.0 else fit.objective


def dispersion(squares: float, counted: int, parameters: int) -> float:
    """How much flatter than for pure noise the likelihood is: what a model leaves beyond it, a parameter.

    Args:
        squares: that it leaves.
        counted: values.
        parameters: of the model.
    """
    return max(1.0, (squares - NOISE.at**2 * counted) / parameters)


def gain_needed(fit: Fit) -> float:
    """Fall of the squared residuals that one more effect must bring."""
    return GAINS.of_one_more(fit.counted, fit.unsure)
