"""A station in Drake's browser view: the links, and the cylinders between the mounts that are simulated."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from pydrake.geometry import (
    Cylinder,
    GeometryInstance,
    MakePhongIllustrationProperties,
    Meshcat,
    MeshcatVisualizer,
    MeshcatVisualizerParams,
    Rgba,
    Role,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.framework import DiagramBuilder

from hydrolek_drake.physics.linkage import stroke_and_lever
from hydrolek_drake.rigs import Rig
from hydrolek_drake.station.chain import read_chain, read_mounts
from hydrolek_drake.station.plant import RigPlant
from hydrolek_drake.visualization.controls import with_open_controls
from hydrolek_drake.visualization.cylinders import CylinderMount, add_cylinders
from hydrolek_drake.visualization.urdf_tree import arm_cylinders

# Composition of the picture, not physics.
_WALL = 1.2  # outer to inner radius of a barrel
_ARMS_EYE, _ARMS_TARGET = (2.35, -1.75, 1.6), (0.8, 0.02, 0.6)
_JOINT_EYE, _JOINT_TARGET = (0.3, -0.9, 0.35), (0.13, 0.0, 0.13)
_STRUT_RADIUS = 0.012
_STRUT_COLOUR = Rgba(0.45, 0.47, 0.5)
_BACKGROUND = [0.86, 0.90, 0.94], [0.97, 0.98, 0.99]
_FRAMES_PER_SECOND = 30.0


@dataclass
class StationView:
    """Shows a station in a Meshcat: pass its `add` as `make_station(..., visualize=view.add)`.

    Attributes:
        meshcat: the browser view.
        visualizer: the system that publishes to it, once the station is built.
    """

    meshcat: Meshcat
    visualizer: MeshcatVisualizer | None = field(default=None, init=False)

    def add(self, builder: DiagramBuilder, body: RigPlant, rig: Rig, joints: np.ndarray) -> None:
        """Add the visualizer and the moving cylinders to a station's diagram."""
        mounts = drawn_cylinders(body, rig, joints)
        if mounts:
            add_cylinders(builder, body.plant, body.scene_graph, mounts)
        if rig.variant(rig.joints[0], "load") != "arm":
            _add_levers(body, rig, mounts)
        settings = MeshcatVisualizerParams()
        settings.role = Role.kIllustration
        settings.publish_period = 1.0 / _FRAMES_PER_SECOND
        self.visualizer = MeshcatVisualizer.AddToBuilder(builder, body.scene_graph, self.meshcat, settings)
        self.visualizer.set_name("meshcat_visualizer")
        arms = rig.variant(rig.joints[0], "load") == "arm"
        eye, target = (_ARMS_EYE, _ARMS_TARGET) if arms else (_JOINT_EYE, _JOINT_TARGET)
        self.meshcat.SetCameraPose(np.array(eye), np.array(target))
        self.meshcat.SetProperty("/Axes", "visible", False)
        self.meshcat.SetProperty("/Grid", "visible", arms)
        for where, colour in zip(("top_color", "bottom_color"), _BACKGROUND, strict=True):
            self.meshcat.SetProperty("/Background", where, colour)

    def static_html(self) -> str:
        """The view as a page that needs no network, with the controls of the recording open."""
        return with_open_controls(self.meshcat.StaticHtml())

    def record(self, run: Callable[[], object]) -> None:
        """Call `run` and keep what is shown meanwhile, to be played with the time slider."""
        assert self.visualizer is not None  # `add` comes first
        self.visualizer.StartRecording(set_transforms_while_recording=True)
        try:
            run()
        finally:
            self.visualizer.StopRecording()
            self.visualizer.PublishRecording()


def drawn_cylinders(body: RigPlant, rig: Rig, joints: np.ndarray) -> list[CylinderMount]:
    """The rig's linear cylinders at the mounts that the simulation pushes at, and those of held joints."""
    plant = body.plant
    chain = read_chain(plant, rig.joints)
    drawn = []
    for mount in read_mounts(plant, rig.joints, joints, chain):
        record = joints[mount.joint]
        area_a, area_b = float(record["cylinder"]["area_a"]), float(record["cylinder"]["area_b"])
        ends = [
            float(record["linkage"]["zero_stroke_length"]) + stroke_and_lever(float(stop), record)[0]
            for stop in (record["load"]["lower_stop"], record["load"]["upper_stop"])
        ]
        parent = plant.world_body() if mount.parent is None else plant.get_body(mount.parent)
        drawn.append(
            CylinderMount(
                name=rig.joints[mount.joint],
                parent_body=parent.name(),
                child_body=plant.get_body(mount.child).name(),
                p_parent=tuple(mount.p_parent),
                p_child=tuple(mount.p_child),
                barrel_radius=_WALL * float(np.sqrt(area_a / np.pi)),
                rod_radius=float(np.sqrt(max(area_a - area_b, 0.04 * area_a) / np.pi)),
                closed_length=min(ends),
            )
        )
    if rig.variant(rig.joints[0], "load") == "arm":
        drawn += [
            CylinderMount(
                name=held.joint,
                parent_body=held.parent,
                child_body=held.child,
                p_parent=tuple(held.p_parent),
                p_child=tuple(held.p_child),
                barrel_radius=held.barrel_radius,
                rod_radius=held.rod_radius,
                closed_length=held.closed_length,
            )
            for held in arm_cylinders()
            if held.joint not in rig.joints
        ]
    return drawn


def _add_levers(body: RigPlant, rig: Rig, mounts: list[CylinderMount]) -> None:
    """Struts from a joint's axis to the mounts of its cylinder, where no link is drawn that carries them."""
    plant = body.plant
    for mount in mounts:
        joint = plant.GetJointByName(mount.name)
        axis = joint.frame_on_parent().GetFixedPoseInBodyFrame().translation()
        for carrier, start, end in (
            (joint.parent_body(), axis, np.array(mount.p_parent)),
            (joint.child_body(), np.zeros(3), np.array(mount.p_child)),
        ):
            along = end - start
            pose = RigidTransform(RotationMatrix.MakeFromOneVector(along, 2), (start + end) / 2.0)
            strut = GeometryInstance(
                pose,
                Cylinder(_STRUT_RADIUS, float(np.linalg.norm(along))),
                f"{mount.name}_lever_{carrier.name()}",
            )
            properties = MakePhongIllustrationProperties(
                [_STRUT_COLOUR.r(), _STRUT_COLOUR.g(), _STRUT_COLOUR.b(), _STRUT_COLOUR.a()]
            )
            strut.set_illustration_properties(properties)
            source = plant.get_source_id()
            frame = plant.GetBodyFrameIdOrThrow(carrier.index())
            body.scene_graph.RegisterGeometry(source, frame, strut)
