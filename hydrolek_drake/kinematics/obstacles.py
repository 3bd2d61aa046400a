"""Why an arm cannot reach a target: too far, the direction, or the ends of the cylinders' strokes."""

import math
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.kinematics.chain import Chain
from hydrolek_drake.kinematics.compiled_forward import direction_of
from hydrolek_drake.kinematics.direction_kernel import solve_direction
from hydrolek_drake.kinematics.position_kernel import solve_position

Array = NDArray[np.float64]

ON_LIMIT = 1e-6
"""Angle in rad: a joint this little outside its limit is set onto it, which moves the tool by some 2 um at most."""

_ANY_ANGLE = np.array([np.full(5, -np.pi), np.full(5, np.pi)])
_NO_AIM = np.zeros(3)
_NOT_WORTH_NAMING = 1e-4  # rad: a joint's excess beside larger ones of other joints


class Obstacle(Enum):
    """What keeps the arm from a target."""

    POSITION = "position"
    ORIENTATION = "orientation"
    STROKE_LIMITS = "stroke limits"


def find_obstacle(chain: Chain, target: Array, aim: Array | None) -> tuple[Obstacle, str]:
    """What keeps the arm from a target that it has no posture for.

    - POSITION: the links are too short, or too long, whatever the joints do;
    - STROKE_LIMITS: joints that turned further would do;
    - ORIENTATION: the point can be reached, but no joint angles at all give it this direction.

    Args:
        chain: The arm.
        target: Point from the axis of joint 1, in m, shape (3,).
        aim: Unit vector of the tool's direction, shape (3,); None for the point alone.

    Returns:
        The obstacle, and a sentence with the figures.
    """
    limits, middle = chain.limits, chain.middle[:5]
    q = np.empty(8)
    outside = solve_position(target, chain.links, limits, ON_LIMIT, middle, _NO_AIM, q)
    where = f"the {chain.side} arm cannot put its {chain.point} at {_mm(target + chain.base)} mm"
    if outside > 0.0:
        free = np.empty(8)
        if solve_position(target, chain.links, _ANY_ANGLE, ON_LIMIT, middle, _NO_AIM, free) > 0.0:
            return Obstacle.POSITION, f"{where}: {_reach(chain, target)}"
        return Obstacle.STROKE_LIMITS, f"{where}: {_beyond(chain, q[:5])}"
    assert aim is not None  # the point alone can be reached, so a direction was asked for
    solve_position(target, chain.links, limits, ON_LIMIT, middle, aim, q)
    nearest = np.empty(3)
    direction_of(q, nearest)
    degrees = math.degrees(math.acos(min(1.0, max(-1.0, float(nearest @ aim)))))
    instead = (
        f"; the nearest direction there is ({nearest[0]:.3f}, {nearest[1]:.3f}, {nearest[2]:.3f}), "
        f"{degrees:.1f} deg away"
    )
    found = np.empty((64, 5))
    count = solve_direction(target, aim, chain.links, _ANY_ANGLE, 0.0, found)
    where += f" along ({aim[0]:.3f}, {aim[1]:.3f}, {aim[2]:.3f})"
    if count == 0:
        return Obstacle.ORIENTATION, f"{where}: no joint angles give this direction there{instead}"
    least = min(found[:count], key=lambda angles: float(np.sum(_excess(chain, angles))))
    return Obstacle.STROKE_LIMITS, f"{where}: {_beyond(chain, least)}{instead}"


def _excess(chain: Chain, angles: Array) -> Array:
    return np.maximum(0.0, np.maximum(chain.lower[:5] - angles, angles - chain.upper[:5]))


def _beyond(chain: Chain, angles: Array) -> str:
    """Which joints would have to leave their travel, and by how much."""
    parts, excess = [], _excess(chain, angles)
    for joint in np.flatnonzero(excess > min(_NOT_WORTH_NAMING, 0.5 * float(np.max(excess)))):
        limit = chain.lower[joint] if angles[joint] < chain.lower[joint] else chain.upper[joint]
        parts.append(
            f"joint {joint + 1} would have to turn to {math.degrees(angles[joint]):.2f} deg, "
            f"its stroke ends at {math.degrees(limit):.2f} deg"
        )
    if not parts:
        return "the links would have to be longer or shorter with the strokes that the joints have"
    return " and ".join(parts)


def _reach(chain: Chain, target: Array) -> str:
    """How far the target is from joint 2, and what the links span from there."""
    links = chain.links
    upper = float(np.hypot(*links[1]))
    q5 = np.linspace(-np.pi, np.pi, 721)
    spans = []
    for sign in (1.0, -1.0):
        x = links[2, 0] + sign * (links[3, 0] + links[4, 0] * np.cos(q5) - links[4, 1] * np.sin(q5))
        y = links[2, 1] + links[3, 1] + links[4, 0] * np.sin(q5) + links[4, 1] * np.cos(q5)
        spans.append(np.hypot(x, y))
    longest = upper + float(np.max(spans))
    shortest = max(0.0, upper - float(np.max(spans)))
    across = math.hypot(target[0], target[2])
    from_joint_2 = math.hypot(across - links[0, 0], target[1] - links[0, 1])
    if from_joint_2 > longest:
        return f"it is {from_joint_2:.3f} m from joint 2, from which the arm is {longest:.3f} m long at most"
    if from_joint_2 < shortest:
        return f"it is {from_joint_2:.3f} m from joint 2, nearer than {shortest:.3f} m, to which the arm can fold"
    return f"no joint angles at all lead there ({from_joint_2:.3f} m from joint 2)"


def _mm(point: Array) -> str:
    return "(" + ", ".join(f"{1e3 * value:.1f}" for value in point) + ")"
