"""One parameter at a time over its whole range, as in section 4.3.2 and appendix B."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.identification.sensitivity.response import Response

VALUES = 20
"""Of each parameter, as in figure 4.7."""


@dataclass(frozen=True)
class OneAtATime:
    """Outputs and their spread.

    Attributes:
        values: that each parameter was given (SI). # (parameters, values)
        outputs: # (parameters, values, n)
        spread: standard deviation of the output over the values, rms in each segment. # (parameters, segments)
    """

    values: np.ndarray
    outputs: np.ndarray
    spread: np.ndarray


def one_at_a_time(
    response: Response, values: int = VALUES, progress: Callable[[int], None] = lambda done: None
) -> OneAtATime:
    """Vary each parameter over equal steps of its scale, all others as the rig has them.

    Args:
        response: output as a function of the parameters.
        values: of each parameter.
        progress: told after each parameter how many are done.
    """
    nominal = response.parameters.unit()
    outputs = np.empty((len(nominal), values, len(response.time)))
    given = np.empty((len(nominal), values))
    for i, free in enumerate(response.parameters.free):
        steps = np.linspace(0.0, 1.0, values)
        units = np.tile(nominal, (values, 1))
        units[:, i] = steps
        outputs[i] = response.of_all(list(units))
        given[i] = [free.from_unit(float(u)) for u in steps]
        progress(i + 1)
    with np.errstate(invalid="ignore", divide="ignore"):  # what diverged counts neither way
        counted = np.isfinite(outputs).sum(axis=1, keepdims=True)
        centred = outputs - np.nansum(outputs, axis=1, keepdims=True) / counted
        spread = np.sqrt(np.nansum(centred**2, axis=1) / counted[:, 0])
    return OneAtATime(given, outputs, response.per_segment(spread))
