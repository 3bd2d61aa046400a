"""How many points Sobol's sequence takes."""

import math

from hydrolek_drake.errors import InputError


def check_points(points: int) -> None:
    """Refuse a number of points that Sobol's sequence cannot take.

    Raises:
        InputError: not a power of two.
    """
    if points < 2 or points & (points - 1):
        near = 2 ** max(round(math.log2(max(points, 2))), 1)
        raise InputError(f"--sobol {points}: Sobol's sequence needs a power of two, such as {near}")
