"""What a recording can tell of the parameters: standard errors, correlations, and blurred directions."""

from dataclasses import dataclass

import numpy as np

CONFUSED = 0.95
"""Correlation above which two parameters cannot be told apart in practice."""


@dataclass(frozen=True)
class Identifiability:
    """Linear analysis of a Jacobian in units of the noise and of the parameters' ranges.

    Attributes:
        paths: of the parameters.
        deviation: standard error of each as a part of its range; infinite where the data say nothing. # (n,)
        correlation: of the estimates. # (n, n)
        singular_values: in falling order. # (n,)
        directions: right singular vectors, one a row, in the same order. # (n, n)
    """

    paths: tuple[str, ...]
    deviation: np.ndarray
    correlation: np.ndarray
    singular_values: np.ndarray
    directions: np.ndarray

    @property
    def confused(self) -> tuple[tuple[str, str, float], ...]:
        """Pairs with a correlation of more than `CONFUSED`, worst first."""
        pairs = [
            (self.paths[i], self.paths[j], float(self.correlation[i, j]))
            for i in range(len(self.paths))
            for j in range(i)
            if abs(self.correlation[i, j]) > CONFUSED
        ]
        return tuple(sorted(pairs, key=lambda pair: -abs(pair[2])))

    def blurred(self, of_range: float = 1.0) -> tuple[dict[str, float], ...]:
        """Combinations of parameters that are known less well than a part of their range, worst first.

        Each is the singular vector's entries above a tenth, by path.
        """
        rows = []
        for value, row in zip(self.singular_values[::-1], self.directions[::-1], strict=True):
            if value * of_range < 1.0:
                sign = np.sign(row[np.argmax(np.abs(row))])
                rows.append(
                    {p: float(sign * x) for p, x in zip(self.paths, row, strict=True) if abs(x) > 0.1}
                )
        return tuple(rows)


def identifiability(paths: tuple[str, ...], jacobian: np.ndarray) -> Identifiability:
    """Analyse d residuals / d place in the unit cube, residuals in units of the noise. # (values, n)."""
    # fewer values than parameters leave directions free
    lacking = max(jacobian.shape[1] - jacobian.shape[0], 0)
    _, values, directions = np.linalg.svd(np.pad(jacobian, ((0, lacking), (0, 0))), full_matrices=False)
    silent = np.finfo(float).eps * max(jacobian.shape) * max(float(values[0]), 1e-300)
    spread = directions.T / np.maximum(values, silent)
    covariance = spread @ spread.T
    deviation = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(deviation, deviation)
    said_nothing = np.linalg.norm(jacobian, axis=0) <= silent
    deviation[said_nothing] = np.inf
    return Identifiability(paths, deviation, correlation, values, directions)
