"""The parameters of joints that move together, fitted with what the joints do to each other.

Rollouts of one joint take the movement of the others as given, so that their Jacobian says nothing of how a parameter
acts through the other joints, and fits that take turns with the Diagram (`together`) end where neither moves on,
though not at the least residuals. One Jacobian by the Diagram would take minutes. But every place that was tried tells
how the residuals really changed on the way there: the rollouts' Jacobian is corrected so that it agrees with all of
these ways (a multisecant Broyden method; Broyden, Mathematics of Computation 19 (1965) 577; Fang and Saad, Numerical
Linear Algebra with Applications 16 (2009) 197), and steps are damped as in Marquardt (SIAM J. 11 (1963) 431).
"""

import numpy as np
from scipy.optimize import lsq_linear

from hydrolek_drake.diagnosis.effort import FALLING
from hydrolek_drake.diagnosis.together import felt_together
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench

MOST_ROUNDS = 10
"""So many places at most are tried, each of them by the Diagram."""

PATIENCE = 4
"""So many rounds one after the other may bring less than `FALLING` of what they promise before they end; a step that
was too long is one of them."""

WORTH = 1.0
"""A step that promises less than so many squares moves no parameter by more than its own standard deviation."""

DAMPED, LESS, MORE = 1e-3, 0.2, 8.0
"""Marquardt's damping at first, after a step that helped, and after one that did not (times what it was)."""

ALIKE = 1e-3
"""Ways that are linear combinations of others to this share tell nothing new."""


def settled_together(bench: Workbench, hypothesis: Hypothesis) -> Hypothesis:
    """A fit near the noise, gone on with by the Diagram, whose telling replaces that of the training data.

    It does not end where the noise is reached: a noise that is told 2 % too high leaves hundreds of squares, and a
    valley along which a parameter is off by many times its standard deviation.

    Args:
        bench: fits, and the training data.
        hypothesis: fitted to these.

    Returns:
        The best place that was tried, with its fit as the joints' own rollouts have it there.
    """
    parameters = bench.parameters(hypothesis.effects)
    moving = np.flatnonzero(bench.movable(hypothesis.effects, parameters))
    weighed = bench.training

    def at(unit: np.ndarray) -> Hypothesis:
        bench.alive()
        values = parameters.values(unit)
        bench.training = tuple(felt_together(bench.rig.with_values(values), weighed))
        return bench.fit(hypothesis.effects, values, bench.fine, 1)  # which only tells what is left there

    best, training = at(hypothesis.fit.unit), bench.training
    ways: list[np.ndarray] = []
    changes: list[np.ndarray] = []
    damping, waited = DAMPED, 0
    for _ in range(MOST_ROUNDS):
        jacobian = corrected(best.fit.jacobian[:, moving], ways, changes)
        way = damped_step(best, jacobian, moving, damping)
        promised = promised_fall(best, jacobian, moving, way)
        if promised < WORTH or waited == PATIENCE:
            break
        there = best.fit.unit.copy()
        there[moving] = np.clip(there[moving] + way, 0.0, 1.0)
        tried = at(there)
        ways.append((tried.fit.unit - best.fit.unit)[moving])
        changes.append(tried.fit.residuals - best.fit.residuals)
        fall = best.fit.objective - tried.fit.objective
        waited = 0 if fall > FALLING * promised else waited + 1
        if fall > 0.0:
            best, training = tried, bench.training
            damping *= LESS
        else:
            damping *= MORE
    bench.training = training
    return best


def corrected(jacobian: np.ndarray, ways: list[np.ndarray], changes: list[np.ndarray]) -> np.ndarray:
    """The Jacobian nearest to this one that agrees with how the residuals changed on some ways. # (values, n).

    Args:
        jacobian: of the residuals, as far as it is known. # (values, n)
        ways: from one place to another one. # each (n,)
        changes: of the residuals on these ways. # each (values,)
    """
    if not ways:
        return jacobian
    along, change = np.stack(ways, axis=1), np.stack(changes, axis=1)
    return jacobian + (change - jacobian @ along) @ np.linalg.pinv(along, rcond=ALIKE)


def damped_step(best: Hypothesis, jacobian: np.ndarray, moving: np.ndarray, damping: float) -> np.ndarray:
    """Marquardt's step within the ranges, with the prior of the parameters. # (moving,).

    Args:
        best: where it begins.
        jacobian: of the residuals with the moving parameters. # (values, moving)
        moving: places of the parameters that may move. # (moving,)
        damping: share of the squared columns that is added to the normal equations' diagonal.
    """
    fit = best.fit
    scale = np.linalg.norm(jacobian, axis=0)
    rows = np.vstack([jacobian, fit.prior_jacobian[:, moving], np.sqrt(damping) * np.diag(scale)])
    wanted = -np.concatenate([fit.residuals, fit.off_prior, np.zeros(moving.size)])
    room = np.finfo(float).eps  # a parameter at an end of its range would leave no room between the bounds
    low, high = -fit.unit[moving] - room, 1.0 - fit.unit[moving] + room
    return np.asarray(lsq_linear(rows, wanted, bounds=(low, high)).x)


def promised_fall(best: Hypothesis, jacobian: np.ndarray, moving: np.ndarray, way: np.ndarray) -> float:
    """By how much a step lets the squares fall, those of the prior among them, if the Jacobian holds.

    Args:
        best: where it begins.
        jacobian: of the residuals with the moving parameters. # (values, moving)
        moving: places of the parameters that may move. # (moving,)
        way: the step. # (moving,)
    """
    fit = best.fit
    residuals = fit.residuals + jacobian @ way
    off_prior = fit.off_prior + fit.prior_jacobian[:, moving] @ way
    return fit.objective - float(residuals @ residuals + off_prior @ off_prior)
