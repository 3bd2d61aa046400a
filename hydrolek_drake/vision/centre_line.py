"""Centre line of the selected object, snapping to it, and the cut across it: thesis section 5.2.5, in pixels."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError

Array = NDArray[np.float64]

_PIXEL_VARIANCE = 1.0 / 12.0  # of a square pixel about its middle, as Matlab's regionprops adds it


@dataclass(frozen=True)
class CentreLine:
    """What Matlab's `regionprops` gives: the ellipse with the region's second moments.

    Attributes:
        centre: x, y in px, y downwards; shape (2,).
        orientation: Angle of the major axis from the picture's x axis, anticlockwise as seen, in rad, from -pi/2
            to pi/2.
        length: Major axis in px, 2/sqrt(3) = 1.155 times the length of a rectangle.
        width: Minor axis in px, likewise.
        ends: Both ends by (5.1), x, y in px; shape (2, 2).
    """

    centre: Array
    orientation: float
    length: float
    width: float
    ends: Array

    def direction(self) -> Array:
        """Unit vector along the line from its first to its second end, x and y, shape (2,)."""
        return np.array([math.cos(self.orientation), -math.sin(self.orientation)])

    def snap(self, pixel: ArrayLike) -> Array:
        """The point of the line nearest to a click, by columns or by rows as in the thesis.

        Below 45 degrees the line's point with the click's x is taken, else that with its y; beyond an end, the
        end. The click need not be on the middle, and the gripper's fingers end up on either side of the pipe.

        Args:
            pixel: x, y in px, shape (2,).

        Returns:
            Point in px, shape (2,).
        """
        axis = 0 if abs(self.orientation) < math.pi / 4 else 1
        first, second = self.ends
        share = (np.asarray(pixel, dtype=float)[axis] - first[axis]) / (second[axis] - first[axis])
        return first + min(max(float(share), 0.0), 1.0) * (second - first)

    def cut(self, at: ArrayLike, clearance: float) -> Array:
        """Start and end of a cut through `at`, perpendicular to the line.

        Args:
            at: x, y in px, shape (2,).
            clearance: What each end lies beyond the minor axis, in px.

        Returns:
            Start and end in px, shape (2, 2).
        """
        across = np.array(
            [math.cos(self.orientation + math.pi / 2), -math.sin(self.orientation + math.pi / 2)]
        )
        reach = self.width / 2 + clearance
        return np.asarray(at, dtype=float) + np.outer([-reach, reach], across)


def centre_line(selected: NDArray[np.bool_]) -> CentreLine:
    """The line through the selected object by thesis equation (5.1).

    X_1 = X_co - length/2 cos(theta),  Y_1 = Y_co + length/2 sin(theta), and the second end with opposite signs.

    Args:
        selected: The object, shape (h, w).

    Raises:
        InputError: Nothing is selected.
    """
    rows, columns = np.nonzero(selected)
    if not len(rows):
        raise InputError("nothing is selected; click on an object first")
    centre = np.array([columns.mean(), rows.mean()])
    x, y = columns - centre[0], centre[1] - rows  # y upwards, as orientations are measured
    xx, yy, xy = np.mean(x * x) + _PIXEL_VARIANCE, np.mean(y * y) + _PIXEL_VARIANCE, np.mean(x * y)
    spread = math.hypot((xx - yy) / 2, xy)
    length = 4.0 * math.sqrt((xx + yy) / 2 + spread)
    width = 4.0 * math.sqrt(max(0.0, (xx + yy) / 2 - spread))
    theta = 0.5 * math.atan2(2 * xy, xx - yy)
    half = length / 2 * np.array([math.cos(theta), -math.sin(theta)])
    return CentreLine(centre, theta, length, width, np.stack([centre - half, centre + half]))
