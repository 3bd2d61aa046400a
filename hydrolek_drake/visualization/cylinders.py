"""Cylinders that move with the links: a barrel and a rod between the mounts of each."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import (
    Cylinder,
    FrameId,
    FramePoseVector,
    GeometryFrame,
    GeometryInstance,
    IllustrationProperties,
    PerceptionProperties,
    RenderLabel,
    Rgba,
    SceneGraph,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import DiagramBuilder, LeafSystem

from hydrolek_drake.kinematics.arms import arm_joint, make_arms_plant
from hydrolek_drake.kinematics.cylinder_linkage import cylinder_linkages

_BARREL_COLOUR = Rgba(0.20, 0.21, 0.24)
_ROD_COLOUR = Rgba(0.85, 0.86, 0.88)


@dataclass(frozen=True)
class CylinderMount:
    """One linear cylinder to be drawn.

    Attributes:
        name: Name of the joint that it drives; names the shapes too.
        parent_body: Name of the body that carries the barrel.
        child_body: Name of the body that the rod moves.
        p_parent: Barrel's mount in the parent body's frame, in m.
        p_child: Rod's mount in the child body's frame, in m.
        barrel_radius: Outer radius of the barrel, in m.
        rod_radius: Radius of the rod, in m.
        closed_length: Length from pin to pin with the rod fully retracted, in m.
    """

    name: str
    parent_body: str
    child_body: str
    p_parent: tuple[float, float, float]
    p_child: tuple[float, float, float]
    barrel_radius: float
    rod_radius: float
    closed_length: float


def arm_cylinder_mounts() -> list[CylinderMount]:
    """The ten linear cylinders of both arms, from the mounting geometry and the joints' ranges."""
    plant = make_arms_plant()
    mounts = []
    for name, linkage in cylinder_linkages().items():
        joint = arm_joint(plant, name)
        on_parent = joint.frame_on_parent().GetFixedPoseInBodyFrame()
        on_child = joint.frame_on_child().GetFixedPoseInBodyFrame()
        limits = np.array([joint.position_lower_limit(), joint.position_upper_limit()])
        mounts.append(
            CylinderMount(
                name=name,
                parent_body=joint.parent_body().name(),
                child_body=joint.child_body().name(),
                p_parent=tuple(on_parent @ linkage.parent_point()),
                p_child=tuple(on_child @ linkage.child_point()),
                barrel_radius=linkage.barrel / 2,
                rod_radius=linkage.rod / 2,
                # at an end of the range: the included angle stays within 0 to 180 degrees
                closed_length=float(linkage.length(limits).min()),
            )
        )
    return mounts


class CylinderPoses(LeafSystem):
    """Poses of barrels and rods from the poses of the links.

    Each barrel's frame sits in the mount on the parent body with its z axis towards the mount on the child
    body; each rod's frame sits in the mount on the child body with its z axis towards the other mount.

    .. pydrake_system::

        name: CylinderPoses
        input_ports:
        - body_poses
        output_ports:
        - geometry_pose

    - body_poses: the plant's `body_poses`, a list of world poses by body index.
    - geometry_pose: world poses of all barrel and rod frames, for the scene graph.

    Args:
        plant: Finalized plant that has the mounts' bodies.
        scene_graph: Scene graph that draws the shapes; a source is registered with it.
        mounts: Cylinders to draw.
    """

    def __init__(
        self, plant: MultibodyPlant, scene_graph: SceneGraph, mounts: Sequence[CylinderMount]
    ) -> None:
        super().__init__()
        self.set_name("cylinder_poses")
        self.source_id = scene_graph.RegisterSource("cylinders")
        self._ends: list[_Ends] = []
        for mount in mounts:
            parent, child = plant.GetBodyByName(mount.parent_body), plant.GetBodyByName(mount.child_body)
            frames = []
            for part, shapes, colour, body in (
                ("barrel", _barrel_shapes(mount), _BARREL_COLOUR, parent),
                ("rod", _rod_shapes(mount), _ROD_COLOUR, child),
            ):
                frame = scene_graph.RegisterFrame(self.source_id, GeometryFrame(f"{mount.name}_{part}"))
                frames.append(frame)
                for number, (shape, distance) in enumerate(shapes):
                    name = f"{mount.name}_{part}_{number}"
                    instance = GeometryInstance(_along_z(distance), shape, name)
                    # both have the label of the body they are fixed to, as the body's own shapes have
                    instance.set_illustration_properties(_illustration(colour))
                    instance.set_perception_properties(_perception(colour, RenderLabel(int(body.index()))))
                    scene_graph.RegisterGeometry(self.source_id, frame, instance)
            self._ends.append(_Ends(int(parent.index()), int(child.index()), mount, frames[0], frames[1]))
        self.body_poses = self.DeclareAbstractInputPort("body_poses", AbstractValue.Make([RigidTransform()]))
        self.geometry_pose = self.DeclareAbstractOutputPort(
            "geometry_pose",
            lambda: AbstractValue.Make(FramePoseVector()),
            self._calc_geometry_pose,
            {self.body_poses.ticket()},
        )

    def _calc_geometry_pose(self, context: Any, output: Any) -> None:
        body_poses: Any = self.body_poses.Eval(context)
        poses = FramePoseVector()
        for ends in self._ends:
            parent_point = body_poses[ends.parent_index] @ np.array(ends.mount.p_parent)
            child_point = body_poses[ends.child_index] @ np.array(ends.mount.p_child)
            along = child_point - parent_point
            poses.set_value(ends.barrel_frame, _pointing(parent_point, along))
            poses.set_value(ends.rod_frame, _pointing(child_point, -along))
        output.set_value(poses)


def add_cylinders(
    builder: DiagramBuilder, plant: MultibodyPlant, scene_graph: SceneGraph, mounts: Sequence[CylinderMount]
) -> CylinderPoses:
    """Add cylinders to a diagram and connect them to the plant and the scene graph.

    Args:
        builder: Diagram that has `plant` and `scene_graph`.
        plant: Finalized plant of the arms.
        scene_graph: Its scene graph.
        mounts: Cylinders to draw, for example `arm_cylinder_mounts()`.
    """
    cylinders = CylinderPoses(plant, scene_graph, mounts)
    builder.AddSystem(cylinders)
    builder.Connect(plant.get_body_poses_output_port(), cylinders.body_poses)
    builder.Connect(cylinders.geometry_pose, scene_graph.get_source_pose_port(cylinders.source_id))
    return cylinders


@dataclass(frozen=True)
class _Ends:
    parent_index: int
    child_index: int
    mount: CylinderMount
    barrel_frame: FrameId
    rod_frame: FrameId


def _barrel_shapes(mount: CylinderMount) -> list[tuple[Shape, float]]:
    """Eye, tube and gland with the distances of their centres from the mount.

    The tube ends short of the closed length, so that the rod's eye shows even when the rod is retracted.
    """
    radius, start, end = mount.barrel_radius, 0.4 * mount.barrel_radius, 0.84 * mount.closed_length
    gland = 0.06 * mount.closed_length
    return [
        (Sphere(0.8 * radius), 0.0),
        (Cylinder(radius, end - start), (start + end) / 2),
        (Cylinder(1.12 * radius, gland), end - gland / 2),
    ]


def _rod_shapes(mount: CylinderMount) -> list[tuple[Shape, float]]:
    """Eye and rod; the rod reaches almost to the barrel's mount when it is retracted."""
    length = 0.96 * mount.closed_length
    return [(Sphere(1.5 * mount.rod_radius), 0.0), (Cylinder(mount.rod_radius, length), length / 2)]


def _pointing(origin: Any, direction: Any) -> RigidTransform:
    """Pose at the point `origin` with its z axis along the vector `direction`."""
    return RigidTransform(RotationMatrix.MakeFromOneVector(direction, axis_index=2), origin)


def _along_z(distance: float) -> RigidTransform:
    position: Any = np.array([0.0, 0.0, distance])  # Any: the array types in pydrake's stubs match no array
    return RigidTransform(position)


def _illustration(colour: Rgba) -> IllustrationProperties:
    properties = IllustrationProperties()
    properties.AddProperty("phong", "diffuse", colour)
    return properties


def _perception(colour: Rgba, label: RenderLabel) -> PerceptionProperties:
    properties = PerceptionProperties()
    properties.AddProperty("phong", "diffuse", colour)
    properties.AddProperty("label", "id", label)
    return properties
