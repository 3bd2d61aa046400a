"""Least squares with what reference recordings tell of a machine's own numbers as the prior.

With the reference's mean m and covariance S of the numbers' places u in the unit cube, and a covariance D of how they
may drift from one recording to another, the numbers of a later recording have the prior N(m, S + D). Its squares are
|R (u - m)|^2 with R'R = (S + D)^-1, minimised beside those of the residuals (Bayesian estimation with a Gaussian prior;
Ljung, System Identification, 1999, section 7.4).
"""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether


@dataclass(frozen=True)
class Knowledge:
    """What is known of the machine's own numbers before a recording is seen.

    Attributes:
        mean: places in the unit cube. # (n,)
        information: inverse of their covariance, drift included. # (n, n)
    """

    mean: np.ndarray
    information: np.ndarray

    @property
    def root(self) -> np.ndarray:
        """R, upper triangular, with R'R the information. # (n, n)."""
        return np.linalg.cholesky(self.information).T


def with_drift(mean: np.ndarray, information: np.ndarray, drift: np.ndarray) -> Knowledge:
    """Knowledge of a later recording's numbers: (H^-1 + D)^-1 about the mean.

    Args:
        mean: of the reference. # (n,)
        information: H of the reference. # (n, n)
        drift: standard deviations, in ranges. # (n,)
    """
    covariance = np.linalg.inv(information) + np.diag(drift**2)
    later = np.linalg.inv(covariance)
    return Knowledge(np.clip(mean, 0.0, 1.0), 0.5 * (later + later.T))


class _Known:
    """A problem whose prior is a `Knowledge`; parameters beyond those that it knows are free."""

    _knowledge: Knowledge
    _root: np.ndarray

    def know(self, knowledge: Knowledge) -> None:
        """Take what is known as the prior."""
        self._knowledge, self._root = knowledge, knowledge.root

    def prior_residuals(self, unit: np.ndarray) -> np.ndarray:
        """R (u - m). # (known,)."""
        known = self._knowledge.mean.size
        return np.asarray(self._root @ (unit[:known] - self._knowledge.mean))

    def prior_jacobian(self) -> np.ndarray:
        """R, and nothing for what is not known. # (known, n)."""
        count = len(self.parameters)  # type: ignore[attr-defined]
        return np.pad(self._root, ((0, 0), (0, count - self._knowledge.mean.size)))


class KnownProblem(_Known, Problem):
    """Residuals of joints that move alone, and the distance from what is known."""


class KnownTogether(_Known, ProblemTogether):
    """Residuals of joints that move together, and the distance from what is known."""


Known = TypeVar("Known", KnownProblem, KnownTogether)
