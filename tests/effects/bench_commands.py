"""The bench's geometry and commands that the tests of the effects share."""

import numpy as np

LOWER, UPPER = np.radians(-10.3), np.radians(65.6)
STEP_UP = ((0.0, 0.2), (0.0, 7.0))
AT_REST = ((0.0,), (0.0,))


def lever(angle):
    """Of the bench's cylinder about its joint [m]."""
    included = angle + np.radians(60.0)
    return 0.12 * 0.35 * np.sin(included) / np.sqrt(0.12**2 + 0.35**2 - 2 * 0.12 * 0.35 * np.cos(included))
