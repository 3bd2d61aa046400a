"""What a structure costs, and what a further addition must bring before it is believed."""

import math

from hydrolek_drake.diagnosis.settings import GAINS, NOISE
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.identification.least_squares.least_squares import Fit


def cost(structure: Hypothesis) -> float:
    """Twice the negative log-likelihood of the training data, and what its additions and their parameters cost."""
    additions = sum(c.cost for c in structure.effects)
    return cost_of(structure.fit, structure.fit.objective, additions) + 2.0 * structure.extra


def cost_of(fit: Fit, squares: float, additions: float) -> float:
    """Twice the negative log-likelihood of squares that are left of a fit's data, and what additions cost.

    A model that is right leaves squares as many as there are values, n; one that leaves s n has a discrepancy, whose
    variance, as large as it is most likely, makes that n (1 + log s) (profile likelihood). What takes a share of a
    misfit then counts by that share, and near the noise by its squares. Where a rig says what its equations leave at
    best, that is part of the noise here, for the misfit and for what an addition must bring alike.

    Args:
        fit: to these data.
        squares: that are left, in units of the sensors' noise.
        additions: how many, a law for more than one.
    """
    count = max(fit.counted, 1)
    admitted = 1.0 + fit.admitted / count
    left = squares / admitted
    misfit = count * (1.0 + math.log(left / count)) if left > count else left
    return misfit + gain_needed(fit) / admitted * additions


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
