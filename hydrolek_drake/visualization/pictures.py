"""Still pictures of the arms, drawn without a screen."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    ClippingRange,
    ColorRenderCamera,
    Cylinder,
    GeometryInstance,
    LightParameter,
    MakeRenderEngineVtk,
    PerceptionProperties,
    RenderCameraCore,
    RenderEngineVtkParams,
    RenderLabel,
    Rgba,
    SceneGraph,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.sensors import CameraInfo

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.kinematics.arms import add_arms, arm_joint
from hydrolek_drake.visualization.cylinders import add_cylinders, arm_cylinder_mounts

# Posture and view of the picture in the README: composition, not physics.
SHOW_POSTURE_DEG: Mapping[str, float] = {
    "right_j1": -8.0,
    "right_j2": 50.0,
    "right_j3": -30.0,
    "right_j4": -10.0,
    "right_j5": -38.0,
    "right_j6": 0.0,
    "right_j7": 32.0,
    "left_j1": 10.0,
    "left_j2": 14.0,
    "left_j3": -6.0,
    "left_j4": 12.0,
    "left_j5": -24.0,
    "left_j6": 35.0,
    "left_j7": 20.0,
}
_EYE = (2.75, -1.95, 1.75)
_TARGET = (0.76, 0.02, 0.54)
_BACKGROUND = (0.93, 0.95, 0.97)
_FLOOR = Rgba(0.70, 0.71, 0.73)


def render_scene(
    angles: Mapping[str, float] | None = None,
    *,
    eye: Sequence[float] = _EYE,
    target: Sequence[float] = _TARGET,
    width: int = 1280,
    height: int = 800,
    field_of_view: float = 0.66,
) -> NDArray[np.uint8]:
    """Picture of base, arms and cylinders from one viewpoint.

    Args:
        angles: Joint angles in rad by name; joints that are not named stand as in `SHOW_POSTURE_DEG`.
        eye: Camera position in the world frame, in m.
        target: Point in the middle of the picture, in the world frame, in m.
        width: Picture width in pixels.
        height: Picture height in pixels.
        field_of_view: Vertical opening angle of the camera in rad.

    Returns:
        Red, green and blue, shape (height, width, 3).

    Raises:
        InputError: `angles` names an unknown joint, or the camera looks straight up or down.
    """
    builder = DiagramBuilder()
    arms = add_arms(builder, time_step=0.0)
    add_cylinders(builder, arms.plant, arms.scene_graph, arm_cylinder_mounts())
    _add_floor(arms.scene_graph)
    arms.scene_graph.AddRenderer("vtk", MakeRenderEngineVtk(_renderer_settings()))
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    plant_context = arms.plant.GetMyMutableContextFromRoot(context)
    posture = {name: np.radians(angle) for name, angle in SHOW_POSTURE_DEG.items()} | dict(angles or {})
    for name, angle in posture.items():
        arm_joint(arms.plant, name).set_angle(plant_context, angle)

    core = RenderCameraCore(
        "vtk",
        CameraInfo(width=width, height=height, fov_y=field_of_view),
        ClippingRange(0.01, 50.0),
        RigidTransform(),
    )
    query: Any = arms.scene_graph.get_query_output_port().Eval(arms.scene_graph.GetMyContextFromRoot(context))
    image = query.RenderColorImage(
        ColorRenderCamera(core, False),
        arms.scene_graph.world_frame_id(),
        camera_pose(eye, target),
    )
    return image.data[:, :, :3].copy()


def camera_pose(eye: Sequence[float], target: Sequence[float]) -> RigidTransform:
    """World pose of a camera at `eye` that looks at `target` with the world's z axis upright in the picture.

    The camera frame is Drake's: z along the view, x to the right, y down.

    Raises:
        InputError: The view is vertical or `eye` equals `target`.
    """
    view = np.asarray(target, dtype=float) - np.asarray(eye, dtype=float)
    right = np.cross(view, [0.0, 0.0, 1.0])
    if np.linalg.norm(right) < 1e-9:
        raise InputError(
            f"camera at {tuple(eye)} looks straight up or down at {tuple(target)}; move it sideways"
        )
    right /= np.linalg.norm(right)
    forward = view / np.linalg.norm(view)
    position: Any = np.asarray(eye, dtype=float)
    axes: Any = np.column_stack([right, np.cross(forward, right), forward])
    return RigidTransform(RotationMatrix(axes), position)


def write_picture(path: Path, picture: NDArray[np.uint8]) -> None:
    """Write a picture (height, width, 3) as PNG, all or nothing."""
    encoded, data = cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
    if not encoded:
        raise InputError(
            f"picture of shape {picture.shape} cannot be written as PNG; it must be (height, width, 3)"
        )
    write_whole(path, data.tobytes())


def _add_floor(scene_graph: SceneGraph) -> None:
    """A round floor, no larger than needed: the renderer spreads its shadow map over the whole scene."""
    source = scene_graph.RegisterSource("floor")
    radius, thickness = 3.2, 0.02
    centre: Any = np.array(
        [0.4, 0.0, -thickness / 2]
    )  # Any: the array types in pydrake's stubs match no array
    floor = GeometryInstance(RigidTransform(centre), Cylinder(radius, thickness), "floor")
    properties = PerceptionProperties()
    properties.AddProperty("phong", "diffuse", _FLOOR)
    properties.AddProperty("label", "id", RenderLabel.kDontCare)
    floor.set_perception_properties(properties)
    scene_graph.RegisterAnchoredGeometry(source, floor)


def _renderer_settings() -> RenderEngineVtkParams:
    """Two lights from above that cast visible shadows, and one at the camera whose shadows it cannot see."""
    lights = [
        LightParameter(type="directional", direction=[-0.45, 0.5, -1.0], frame="world", intensity=0.65),
        LightParameter(type="directional", direction=[0.3, 0.1, -1.0], frame="world", intensity=0.3),
        LightParameter(type="directional", direction=[0.0, 0.0, 1.0], frame="camera", intensity=0.85),
    ]
    return RenderEngineVtkParams(
        lights=lights, cast_shadows=True, shadow_map_size=4096, default_clear_color=_BACKGROUND
    )
