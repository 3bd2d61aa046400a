"""What changes of a fit's own parameters cannot make.

Around a fitted model the residuals are r + J d for a small change d of its parameters. What these cannot undo of a
change of the residuals is its part across the columns of J.
"""

import numpy as np

from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.identification.least_squares.least_squares import Fit


class Across:
    """Projection across the columns of a fit's Jacobian."""

    def __init__(self, fit: Fit) -> None:
        """Orthonormal basis of the columns; those that say nothing or cannot move on are left out."""
        norms = np.linalg.norm(fit.jacobian, axis=0)
        use = (norms > 0.0) & (np.abs(fit.unit - 0.5) < 0.5 - FITS.tolerance)
        kept = fit.with_prior[:, use] / norms[use]
        if kept.shape[1]:
            left, singular, _ = np.linalg.svd(kept, full_matrices=False)
            self.basis = left[:, singular > 1e-8 * singular[0]]
        else:
            self.basis = np.zeros((len(fit.with_prior), 0))

    def __call__(self, vector: np.ndarray) -> np.ndarray:
        """The part of a vector that the columns cannot make."""
        return vector - self.basis @ (self.basis.T @ vector)


def gain_of(change: np.ndarray, rest: np.ndarray) -> float:
    """Fall of the squared residuals if a change takes its best positive multiple; of one that diverged nothing.

    Args:
        change: of the residuals, across the fitted parameters' columns. # (values,)
        rest: what the model leaves, across these columns. # (values,)
    """
    if not np.isfinite(change).all():
        return 0.0
    power, along = float(change @ change), -float(change @ rest)
    return along * along / power if along > 0.0 and power > 0.0 else 0.0
