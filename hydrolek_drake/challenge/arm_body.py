"""What one joint of an arm turns, the other joints held: masses and their places, summed link by link.

An own way from the URDF to inertia and gravity, without the MultibodyPlant that the diagnosis takes them from:
forward kinematics with homogeneous matrices, then the parallel-axis theorem about the joint's axis.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

VERTICAL = 1e-9
"""An axis that leans by less than this [rad] is vertical but for rounding."""


@dataclass(frozen=True)
class TurnedBody:
    """A rigid body that turns about a fixed axis.

    Attributes:
        inertia: about the axis [kg m^2].
        moment: of the masses, mass times distance from the axis [kg m].
        phase: angle of the centre of mass above the horizontal at joint angle zero [rad], so that gravity's
            moment against the positive direction is g moment slope cos(angle + phase).
        slope: how much of gravity acts across the axis: 1 for a horizontal axis, 0 for a vertical one.
        tool_distance: of the tool point from the axis [m].
        tool_phase: as phase, of the tool point [rad].
    """

    inertia: float
    moment: float
    phase: float
    slope: float
    tool_distance: float
    tool_phase: float


def turned_body(urdf: Path, joint: str, held: Mapping[str, float]) -> TurnedBody:
    """Sum the links beyond a joint.

    J = sum (axis . R I R^T axis + m rho^2), rho the distance of a link's centre of mass from the axis.

    Args:
        urdf: file of the arms.
        joint: that turns.
        held: angles of the other joints of its arm [rad].
    """
    root = ElementTree.parse(urdf).getroot()
    joints = root.findall("joint")
    parents = {_name(j, "child"): j for j in joints}
    frames: dict[str, np.ndarray] = {}

    def frame(link: str) -> np.ndarray:
        if link not in frames:
            if link not in parents:
                return np.eye(4)
            above = parents[link]
            placed = frame(_name(above, "parent")) @ _placed(above.find("origin"))
            frames[link] = placed @ _turned(above, held.get(str(above.get("name")), 0.0))
        return frames[link]

    def beyond(link: str) -> list[str]:
        below = [_name(j, "child") for j in joints if _name(j, "parent") == link]
        return [link, *(further for child in below for further in beyond(child))]

    moving = next(j for j in joints if j.get("name") == joint)
    first = _name(moving, "child")
    pose = frame(first)
    axis, origin = pose[:3, :3] @ _axis(moving), pose[:3, 3]

    inertia, moment = 0.0, np.zeros(3)
    masses = {str(link.get("name")): link.find("inertial") for link in root.findall("link")}
    for link in beyond(first):
        given = masses[link]
        if given is None:
            continue
        at = frame(link) @ _placed(given.find("origin"))
        mass = float(_attribute(given, "mass", "value"))
        inertia += axis @ at[:3, :3] @ _tensor(given) @ at[:3, :3].T @ axis
        inertia += mass * float(np.sum(_across(axis, at[:3, 3] - origin) ** 2))
        moment += mass * (at[:3, 3] - origin)
    tool = frame(f"{joint.split('_')[0]}_tool")[:3, 3] - origin
    # turning positive moves a point on the horizontal `x` upwards, towards `y`
    x = np.cross([0.0, 0.0, 1.0], axis)
    slope = float(np.linalg.norm(x))
    if slope < VERTICAL:  # gravity has no lever, whatever direction counts as horizontal
        x, slope = _across(axis, np.array([1.0, 0.0, 0.0])), 0.0
    x = x / np.linalg.norm(x)
    y = np.cross(axis, x)
    return TurnedBody(
        inertia=float(inertia),
        moment=float(np.hypot(moment @ x, moment @ y)),
        phase=float(np.arctan2(moment @ y, moment @ x)),
        slope=slope,
        tool_distance=float(np.hypot(tool @ x, tool @ y)),
        tool_phase=float(np.arctan2(tool @ y, tool @ x)),
    )


def _across(axis: np.ndarray, vector: np.ndarray) -> np.ndarray:
    return np.asarray(vector - (vector @ axis) * axis)


def _attribute(element: ElementTree.Element, child: str, name: str) -> str:
    found = element.find(child)
    assert found is not None
    return str(found.get(name))


def _name(joint: ElementTree.Element, end: str) -> str:
    return _attribute(joint, end, "link")


def _numbers(text: str | None, default: str) -> np.ndarray:
    return np.array([float(part) for part in (text or default).split()])


def _placed(origin: ElementTree.Element | None) -> np.ndarray:
    """4x4 matrix of an URDF origin."""
    pose = np.eye(4)
    if origin is not None:
        pose[:3, 3] = _numbers(origin.get("xyz"), "0 0 0")
        pose[:3, :3] = Rotation.from_euler("xyz", _numbers(origin.get("rpy"), "0 0 0")).as_matrix()
    return pose


def _axis(joint: ElementTree.Element) -> np.ndarray:
    given = joint.find("axis")
    axis = _numbers(None if given is None else given.get("xyz"), "1 0 0")
    return np.asarray(axis / np.linalg.norm(axis))


def _turned(joint: ElementTree.Element, angle: float) -> np.ndarray:
    pose = np.eye(4)
    if joint.get("type") != "fixed":
        pose[:3, :3] = Rotation.from_rotvec(angle * _axis(joint)).as_matrix()
    return pose


def _tensor(inertial: ElementTree.Element) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = (
        float(_attribute(inertial, "inertia", name)) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
