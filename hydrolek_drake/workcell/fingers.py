"""A gripper's hand and fingers as rods with round ends, from the boxes of the URDF."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RollPitchYaw

from hydrolek_drake.kinematics.arms import arms_urdf_path

Array = NDArray[np.float64]

MOVING, FIXED = "jaw", "link6"
"""Links that carry the moving finger, and the fixed ones with the hand."""


@dataclass(frozen=True)
class Finger:
    """A box of the URDF as a rod with round ends: its middle line and its half thickness.

    Attributes:
        link: `jaw` or `link6`.
        ends: Of the middle line in the link's frame, in m, shape (2, 3).
        radius: Half the box's thickness in m.
    """

    link: str
    ends: Array
    radius: float


def fingers(side: str) -> list[Finger]:
    """Collision boxes of a gripper's hand, fixed fingers and moving finger."""
    found = []
    for link in ElementTree.parse(arms_urdf_path()).getroot().iter("link"):
        for part in (FIXED, MOVING):
            if link.get("name") != f"{side}_{part}":
                continue
            for collision in link.iter("collision"):
                box, origin = collision.find("geometry/box"), collision.find("origin")
                if box is None or origin is None:
                    continue
                size = _numbers(box.get("size"))
                turned = RollPitchYaw(_numbers(origin.get("rpy", "0 0 0"))).ToRotationMatrix().matrix()
                along = 0.5 * (size[0] - size[1]) * turned[:, 0]
                middle = _numbers(origin.get("xyz"))
                found.append(Finger(part, np.array([middle - along, middle + along]), 0.5 * size[1]))
    return found


def _numbers(text: str | None) -> Array:
    return np.array([float(word) for word in (text or "").split()])
