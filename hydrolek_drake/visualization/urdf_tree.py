"""Links, shapes and joints of the arms, read from the URDF's XML without a multibody plant.

Poses are homogeneous transforms; `X_PC` is the pose of frame C in frame P.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import arms_urdf_path
from hydrolek_drake.kinematics.cylinder_linkage import cylinder_linkages

Array = NDArray[np.float64]

_MOVING_TYPES = ("revolute", "continuous")
_UNPAINTED = (0.7, 0.7, 0.7, 1.0)


@dataclass(frozen=True)
class Shape:
    """What a link looks like, in part.

    Attributes:
        kind: "box" or "cylinder".
        size: edges of a box, or radius and length of a cylinder along its z axis [m].
        pose: in the link's frame, shape (4, 4).
        colour: red, green, blue and opacity, 0 to 1.
    """

    kind: str
    size: tuple[float, ...]
    pose: Array
    colour: tuple[float, ...]


@dataclass(frozen=True)
class TreeJoint:
    """A joint between two links; `axis` is None for a weld.

    Attributes:
        name: of the joint.
        parent: link nearer to the base.
        child: link that it carries.
        origin: of the joint's frame in the parent's, shape (4, 4).
        axis: that it turns about, in the joint's frame, shape (3,).
        limits: smallest and largest angle [rad]; infinite if it has none.
    """

    name: str
    parent: str
    child: str
    origin: Array
    axis: Array | None
    limits: tuple[float, float]


@dataclass(frozen=True)
class UrdfTree:
    """The arms on their base.

    Attributes:
        shapes: link -> what it looks like.
        joints: from the base outwards.
    """

    shapes: dict[str, tuple[Shape, ...]]
    joints: tuple[TreeJoint, ...]

    def moving(self) -> tuple[str, ...]:
        """Names of the joints that turn."""
        return tuple(joint.name for joint in self.joints if joint.axis is not None)

    def link_poses(self, angles: Mapping[str, float]) -> dict[str, Array]:
        """World pose of every link, shape (4, 4) each; X_WC = X_WP X_PJ R(axis, angle).

        Args:
            angles: [rad] by joint; joints that are not named stand at zero.
        """
        poses = {self.joints[0].parent: np.eye(4)}
        for joint in self.joints:
            pose = poses[joint.parent] @ joint.origin
            if joint.axis is not None:
                turn = np.eye(4)
                turn[:3, :3] = Rotation.from_rotvec(angles.get(joint.name, 0.0) * joint.axis).as_matrix()
                pose = pose @ turn
            poses[joint.child] = pose
        return poses


@dataclass(frozen=True)
class TreeCylinder:
    """A hydraulic cylinder between two links of the URDF.

    Attributes:
        joint: that it drives.
        parent: link that carries the barrel.
        child: link that the rod moves.
        p_parent: barrel's mount in the parent's frame [m], shape (3,).
        p_child: rod's mount in the child's frame [m], shape (3,).
        barrel_radius: outer [m].
        rod_radius: [m].
        closed_length: from mount to mount with the rod fully in [m].
    """

    joint: str
    parent: str
    child: str
    p_parent: Array
    p_child: Array
    barrel_radius: float
    rod_radius: float
    closed_length: float


@cache
def arms_tree() -> UrdfTree:
    """The arms as `hydrolek.urdf` has them."""
    return read_tree(arms_urdf_path())


def read_tree(path: Path) -> UrdfTree:
    """Read a URDF with boxes and cylinders.

    Raises:
        InputError: not XML, or another kind of shape or joint.
    """
    try:
        robot = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise InputError(f"{path} cannot be read as URDF: {error}") from None
    colours = {
        material.attrib["name"]: _numbers(color.attrib["rgba"])
        for material in robot.iter("material")
        if (color := material.find("color")) is not None
    }
    shapes = {
        link.attrib["name"]: tuple(_shape(visual, colours, path) for visual in link.findall("visual"))
        for link in robot.findall("link")
    }
    waiting = [_joint(element, path) for element in robot.findall("joint")]
    known = set(shapes) - {joint.child for joint in waiting}
    ordered: list[TreeJoint] = []
    while waiting:
        ready = [joint for joint in waiting if joint.parent in known]
        if not ready:
            raise InputError(f"{path}: joint {waiting[0].name} hangs on no link of the tree")
        ordered += ready
        known |= {joint.child for joint in ready}
        waiting = [joint for joint in waiting if joint not in ready]
    return UrdfTree(shapes, tuple(ordered))


@cache
def arm_cylinders() -> tuple[TreeCylinder, ...]:
    """The ten linear cylinders of both arms with the mounting geometry of `cylinder_mounts.yaml`."""
    joints = {joint.name: joint for joint in arms_tree().joints}
    cylinders = []
    for name, linkage in cylinder_linkages().items():
        joint = joints[name]
        cylinders.append(
            TreeCylinder(
                joint=name,
                parent=joint.parent,
                child=joint.child,
                p_parent=(joint.origin @ np.append(linkage.parent_point(), 1.0))[:3],
                p_child=linkage.child_point(),
                barrel_radius=linkage.barrel / 2.0,
                rod_radius=linkage.rod / 2.0,
                # at an end of the range: the included angle stays within 0 to 180 degrees
                closed_length=float(linkage.length(np.array(joint.limits)).min()),
            )
        )
    return tuple(cylinders)


def _joint(element: ElementTree.Element, path: Path) -> TreeJoint:
    kind, name = element.get("type"), element.attrib["name"]
    if kind not in (*_MOVING_TYPES, "fixed"):
        raise InputError(f"{path}: joint {name} is '{kind}'; use {', '.join(_MOVING_TYPES)} or fixed")
    parent, child, axis, limit = (element.find(tag) for tag in ("parent", "child", "axis", "limit"))
    if parent is None or child is None or (kind != "fixed" and axis is None):
        raise InputError(f"{path}: joint {name} needs parent, child and, if it moves, axis")
    ends = limit.attrib if limit is not None else {}
    return TreeJoint(
        name,
        parent.attrib["link"],
        child.attrib["link"],
        _pose(element.find("origin")),
        None if kind == "fixed" or axis is None else np.array(_numbers(axis.attrib["xyz"])),
        (float(ends.get("lower", -np.inf)), float(ends.get("upper", np.inf))),
    )


def _shape(visual: ElementTree.Element, colours: Mapping[str, tuple[float, ...]], path: Path) -> Shape:
    box, cylinder = visual.find("geometry/box"), visual.find("geometry/cylinder")
    material = visual.find("material")
    colour = colours.get(material.attrib["name"], _UNPAINTED) if material is not None else _UNPAINTED
    pose = _pose(visual.find("origin"))
    if box is not None:
        return Shape("box", _numbers(box.attrib["size"]), pose, colour)
    if cylinder is not None:
        size = (float(cylinder.attrib["radius"]), float(cylinder.attrib["length"]))
        return Shape("cylinder", size, pose, colour)
    raise InputError(f"{path}: a visual is neither box nor cylinder")


def _pose(origin: ElementTree.Element | None) -> Array:
    pose = np.eye(4)
    if origin is not None:
        pose[:3, :3] = Rotation.from_euler("xyz", _numbers(origin.get("rpy", "0 0 0"))).as_matrix()
        pose[:3, 3] = _numbers(origin.get("xyz", "0 0 0"))
    return pose


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(float(word) for word in text.split())
