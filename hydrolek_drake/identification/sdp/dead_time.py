"""Dead time of a step test: the delay with which the integrator fits best."""

import numpy as np

from hydrolek_drake.identification.sdp.refined_iv import integrator_estimate


def dead_time_samples(angle: np.ndarray, voltage: np.ndarray, longest: int) -> float:
    """Delay tau with the least squared output error, refined between samples by a parabola.

    Args:
        angle: y [deg]. # (n,)
        voltage: v [V]. # (n,)
        longest: largest delay that is tried.

    Returns:
        In samples; section 6.1.3 chose it by eye.
    """
    costs = np.array([integrator_estimate(angle, voltage, k).squared_error for k in range(longest + 1)])
    best = int(np.argmin(costs))
    if not 0 < best < longest:
        return float(best)
    before, here, after = costs[best - 1 : best + 2]
    bend = before - 2.0 * here + after
    return best + (0.5 * (before - after) / bend if bend > 0.0 else 0.0)
