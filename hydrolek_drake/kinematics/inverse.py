"""Inverse kinematics of one arm: joint angles for a point, with or without the tool's direction.

Closed form up to one unknown (`direction_kernel.py`) or two (`position_kernel.py`); all postures within the
joint limits, that is the cylinders' strokes, or one clear reason why there is none.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import Chain, arm_chain
from hydrolek_drake.kinematics.direction_kernel import solve_direction
from hydrolek_drake.kinematics.obstacles import ON_LIMIT, Obstacle, find_obstacle
from hydrolek_drake.kinematics.position_kernel import solve_position

Array = NDArray[np.float64]

_MOST_POSTURES = 32
_NO_AIM = np.zeros(3)
_PARALLEL = 1e-12  # squared sine of an angle that counts as none


@dataclass(frozen=True)
class InverseResult:
    """Postures that reach a target, or why there is none.

    Attributes:
        angles: Joints 1 to 6 in rad, one posture a row, nearest to the wanted one first; shape (n, 6).
        obstacle: What keeps the arm from the target; None if `angles` has rows.
        reason: One sentence about it, empty if `angles` has rows.
    """

    angles: Array
    obstacle: Obstacle | None = None
    reason: str = ""

    @property
    def reached(self) -> bool:
        """Whether there is a posture."""
        return len(self.angles) > 0

    def nearest(self) -> Array:
        """The posture nearest to the wanted one, shape (6,).

        Raises:
            InputError: There is none; the message is `reason`.
        """
        if not self.reached:
            raise InputError(self.reason)
        return self.angles[0]


def inverse_position(
    position: ArrayLike,
    side: str = "right",
    *,
    point: str = "tool",
    near: ArrayLike | None = None,
    explain: bool = True,
) -> InverseResult:
    """The posture that puts a point of the arm at `position`, of all such the one nearest to `near`.

    Joints 1 to 5 leave two degrees of freedom, joint 6 a third: it keeps its angle in `near`.

    Args:
        position: Target in the arm base frame (X forward, Y up, Z to the right), in m, shape (3,).
        side: `right` or `left`.
        point: `tool`, the grasp point, or `wrist`, P in the thesis's (5.3).
        near: Wanted joints 1 to 6 in rad, shape (6,); the middle of the travel if not given.
        explain: Whether to find out the reason where there is no posture (takes milliseconds).

    Raises:
        InputError: Unknown arm or point, wrong shapes, numbers that are not finite.
    """
    chain, target, wanted = _checked(position, side, point, near)
    q = np.empty(8)
    outside = solve_position(target, chain.links, chain.limits, ON_LIMIT, wanted[:5], _NO_AIM, q)
    if outside == 0.0:
        return InverseResult(np.append(q[:5], wanted[5])[np.newaxis])
    return _failure(chain, target, None, explain)


def inverse_pose(
    position: ArrayLike,
    direction: ArrayLike,
    side: str = "right",
    *,
    point: str = "tool",
    jaw_axis: ArrayLike | None = None,
    near: ArrayLike | None = None,
    explain: bool = True,
) -> InverseResult:
    """All postures that put a point of the arm at `position` with the tool along `direction`.

    Args:
        position: Target in the arm base frame (X forward, Y up, Z to the right), in m, shape (3,).
        direction: Where the tool shall point, the hand's X, in the arm base frame; any length; shape (3,).
        side: `right` or `left`.
        point: `tool`, the grasp point, or `wrist`, P in the thesis's (5.3).
        jaw_axis: Line that joint 6 shall turn the hand's Z, the axis of the jaws, parallel to (a pipe's
            axis), shape (3,); joint 6 keeps its angle in `near` if not given.
        near: Wanted joints 1 to 6 in rad, shape (6,); the middle of the travel if not given.
        explain: Whether to find out the reason where there is no posture (takes milliseconds).

    Raises:
        InputError: Unknown arm or point, wrong shapes, numbers that are not finite, a direction without
            length, or a jaw axis along the direction.
    """
    chain, target, wanted = _checked(position, side, point, near)
    aim = _unit(direction, "direction")
    found = np.empty((_MOST_POSTURES, 5))
    count = solve_direction(target, aim, chain.links, chain.limits, ON_LIMIT, found)
    if count == 0:
        return _failure(chain, target, aim, explain)
    angles = np.empty((count, 6))
    angles[:, :5] = found[:count]
    angles[:, 5] = wanted[5]
    if jaw_axis is not None:
        line = _unit(jaw_axis, "jaw_axis")
        for row in angles:
            row[5] = _roll(row, line, aim, wanted[5])
    if count > 1:
        angles = angles[np.argsort(np.sum((angles - wanted) ** 2, axis=1), kind="stable")]
    return InverseResult(angles)


def _failure(chain: Chain, target: Array, aim: Array | None, explain: bool) -> InverseResult:
    none = np.empty((0, 6))
    if not explain:
        return InverseResult(none)
    obstacle, reason = find_obstacle(chain, target, aim)
    return InverseResult(none, obstacle, reason)


def _roll(angles: Array, line: Array, aim: Array, wanted: float) -> float:
    """Joint 6 that turns the hand's Z parallel to `line`, nearest to `wanted`; either way round."""
    a = angles[1] + angles[2]
    c1, s1, c4, s4 = math.cos(angles[0]), math.sin(angles[0]), math.cos(angles[3]), math.sin(angles[3])
    x, y, z = math.cos(a) * s4, math.sin(a) * s4, c4  # the hand's Z at joint 6 = 0, before joint 1 turns it
    x, z = c1 * x + s1 * z, -s1 * x + c1 * z
    d_x, d_y, d_z = aim
    # R_x(q6) takes the hand's Z to z cos q6 - y sin q6, with y = z x aim
    across = -(line[0] * (y * d_z - z * d_y) + line[1] * (z * d_x - x * d_z) + line[2] * (x * d_y - y * d_x))
    along = line[0] * x + line[1] * y + line[2] * z
    if across * across + along * along < _PARALLEL:
        raise InputError("jaw_axis is parallel to direction; the jaws can only turn about the direction")
    turn = math.atan2(across, along)
    return turn + math.pi * round((wanted - turn) / math.pi)


def _checked(
    position: ArrayLike, side: str, point: str, near: ArrayLike | None
) -> tuple[Chain, Array, Array]:
    chain = arm_chain(side, point)
    target = np.asarray(position, dtype=float)
    if target.shape != (3,) or not np.isfinite(target).all():
        raise InputError(f"position is {target.tolist()}; give three finite numbers in m")
    wanted = chain.middle if near is None else np.asarray(near, dtype=float)
    if wanted.shape != (6,) or not np.isfinite(wanted).all():
        raise InputError(f"near is {wanted.tolist()}; give six finite joint angles in rad")
    return chain, target - chain.base, wanted


def _unit(vector: ArrayLike, name: str) -> Array:
    array = np.asarray(vector, dtype=float)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise InputError(f"{name} is {array.tolist()}; give three finite numbers")
    length = float(np.sqrt(array @ array))
    if length < 1e-9:
        raise InputError(f"{name} is {array.tolist()}, which has no direction; give a longer vector")
    return array / length
