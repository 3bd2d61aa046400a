"""One arm as flat numbers for the compiled kinematics: in-plane links, joint limits."""

from dataclasses import dataclass
from functools import cache, cached_property
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import arms_urdf_path
from hydrolek_drake.kinematics.forward import arm_geometry

Array = NDArray[np.float64]

SIDES = ("right", "left")
POINTS = ("tool", "wrist")
_AXES = (1, 2, 2, 1, 2, 0)  # Y Z Z Y Z X, Table 5.2: the pattern that the closed forms rest on


@dataclass(frozen=True)
class Chain:
    """Joints 1 to 6 of one arm up to a point beyond joint 5.

    Attributes:
        side: `right` or `left`.
        point: `tool`, the grasp point between the jaws, or `wrist`, the point P of the thesis's chain.
        base: L0 in m, shape (3,).
        links: x and y of L1 to L4 and of the point in the frame of joint 5, in m, shape (5, 2).
        lower: Lower limits of joints 1 to 6 in rad, -inf for a joint that turns without end.
        upper: Upper limits.
    """

    side: str
    point: str
    base: Array
    links: Array
    lower: Array
    upper: Array

    @cached_property
    def limits(self) -> Array:
        """Lower and upper limits of joints 1 to 5 in rad, shape (2, 5)."""
        return np.stack([self.lower[:5], self.upper[:5]])

    @cached_property
    def middle(self) -> Array:
        """Joint angles in the middle of the travel, 0 for a joint that turns without end; shape (6,)."""
        bounded = np.isfinite(self.lower) & np.isfinite(self.upper)
        return np.where(bounded, (np.where(bounded, self.lower, 0) + np.where(bounded, self.upper, 0)) / 2, 0)


@cache
def arm_chain(side: str, point: str = "tool") -> Chain:
    """The chain of one arm, from `arm_geometry.yaml` and the limits of the URDF.

    Raises:
        InputError: Unknown side or point, or a geometry whose axes or links have another pattern than
            the thesis's, for which the closed forms do not hold.
    """
    if side not in SIDES:
        raise InputError(f"arm '{side}' is unknown; choose from {', '.join(SIDES)}")
    if point not in POINTS:
        raise InputError(f"point '{point}' is unknown; choose from {', '.join(POINTS)}")
    geometry = arm_geometry()
    if geometry.axes != _AXES:
        raise InputError("arm_geometry.yaml: joint_axes: the inverse kinematics needs Y, Z, Z, Y, Z, X")
    vectors = geometry.link_vectors
    if np.any(vectors[1:6, 2] != 0.0) or np.any(vectors[6] != 0.0):
        raise InputError(
            "arm_geometry.yaml: link_vectors: the inverse kinematics needs L1 to L5 with z = 0 and L6 = 0"
        )
    if np.any(geometry.tool_vector[1:] != 0.0):
        raise InputError("arm_geometry.yaml: tool_vector: the inverse kinematics needs y = z = 0")
    links = vectors[1:6, :2].copy()
    if point == "tool":
        links[4, 0] += geometry.tool_vector[0]
    lower, upper = joint_limits(side)
    chain = Chain(side, point, vectors[0].copy(), links, lower[:6].copy(), upper[:6].copy())
    for array in (chain.base, chain.links, chain.lower, chain.upper):
        array.flags.writeable = False  # shared by all callers through the cache
    return chain


@cache
def joint_limits(side: str) -> tuple[Array, Array]:
    """Limits of joints 1 to 7 in rad from the URDF, lower and upper, each of shape (7,).

    They are the ends of Table 3.2, that is of the cylinders' strokes (and of the vane's travel, joint 4);
    joint 6 has none.
    """
    robot = ElementTree.parse(arms_urdf_path()).getroot()
    lower, upper = np.full(7, -np.inf), np.full(7, np.inf)
    for joint in robot.iter("joint"):
        name, limit = joint.attrib["name"], joint.find("limit")
        if name.startswith(f"{side}_j") and limit is not None and "lower" in limit.attrib:
            number = int(name.removeprefix(f"{side}_j"))
            lower[number - 1] = float(limit.attrib["lower"])
            upper[number - 1] = float(limit.attrib["upper"])
    lower.flags.writeable = upper.flags.writeable = False
    return lower, upper
