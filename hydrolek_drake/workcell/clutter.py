"""Rendered tables full of things, with the number of the thing that each pixel shows: to judge a selection by."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    Box,
    ClippingRange,
    ColorRenderCamera,
    Cylinder,
    DepthRange,
    DepthRenderCamera,
    GeometryInstance,
    MakePhongIllustrationProperties,
    PerceptionProperties,
    RenderCameraCore,
    RenderLabel,
    SceneGraph,
    Sphere,
)
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.sensors import CameraInfo

from hydrolek_drake.vision.camera import thesis_camera
from hydrolek_drake.vision.frames import Frame
from hydrolek_drake.vision.kinect_noise import kinect_depth
from hydrolek_drake.workcell.pipe import workcell_entries
from hydrolek_drake.workcell.scene import RENDERER, add_renderer

Array = NDArray[np.float64]

_ROOM = 1  # label of floor, wall and table
_TRIES = 200  # places that are drawn before a thing is left out
_BEYOND = 10.0  # m, of the renderer


@dataclass(frozen=True)
class LabelledFrame:
    """A frame and what it shows.

    Attributes:
        frame: As the Kinect gives it, with noise, steps, holes and shadow.
        labels: 10, 20, 30, ... on the things, 1 on the room, 0 on nothing; shape (h, w).
        kinds: Name of each thing, such as `rod`; the first is labelled 10.
    """

    frame: Frame
    labels: NDArray[np.uint8]
    kinds: tuple[str, ...]


@dataclass(frozen=True)
class _Thing:
    kind: str
    shape: Any
    pose: RigidTransform
    footprint: float  # radius in m that it keeps for itself on the table


def cluttered_frame(generator: np.random.Generator) -> LabelledFrame:
    """A table with tins, boxes, balls, stacks, pipes and thin rods before one another, from a random point of view.

    Args:
        generator: Of everything: things, places, colours, point of view, the sensor's noise.
    """
    values = workcell_entries()["clutter"]
    things = _things(values, generator)
    builder = DiagramBuilder()
    graph = builder.AddSystem(SceneGraph())
    source = graph.RegisterSource("clutter")
    add_renderer(graph)
    _furnish(graph, source, values, generator)
    for number, thing in enumerate(things):
        _register(graph, source, thing.shape, thing.pose, generator.uniform(0.1, 0.9, 3), 10 * (number + 1))
    builder.ExportOutput(graph.get_query_output_port(), "query")
    diagram = builder.Build()
    query = diagram.GetOutputPort("query").Eval(diagram.CreateDefaultContext())
    camera, pose, core = thesis_camera(), _point_of_view(values, generator), _core()
    world = graph.world_frame_id()
    colour = query.RenderColorImage(ColorRenderCamera(core, False), world, pose).data
    depth = query.RenderDepthImage(DepthRenderCamera(core, DepthRange(0.05, _BEYOND)), world, pose).data
    labels = query.RenderLabelImage(ColorRenderCamera(core, False), world, pose).data[:, :, 0]
    shown = np.where((labels >= 0) & (labels < 256), labels, 0).astype(np.uint8)
    reported = kinect_depth(np.array(depth[:, :, 0], dtype=float), camera, generator)
    frame = Frame(np.ascontiguousarray(colour[:, :, 2::-1]), reported, camera, "clutter")
    return LabelledFrame(frame, shown, tuple(thing.kind for thing in things))


def _core() -> RenderCameraCore:
    camera = thesis_camera()
    intrinsics = CameraInfo(
        camera.width, camera.height, camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y
    )
    return RenderCameraCore(RENDERER, intrinsics, ClippingRange(0.05, _BEYOND), RigidTransform())


def _point_of_view(values: dict[str, Any], generator: np.random.Generator) -> RigidTransform:
    """Camera that looks at the table's middle: X right, Y down, Z forwards."""
    distance, tilt = (
        generator.uniform(*values["distance"]),
        np.radians(generator.uniform(*values["tilt_deg"])),
    )
    around = generator.uniform(-np.pi, np.pi)
    forwards = np.array([np.cos(tilt) * np.cos(around), np.cos(tilt) * np.sin(around), -np.sin(tilt)])
    right = np.cross(forwards, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    turn = np.column_stack([right, np.cross(forwards, right), forwards])
    look_at = np.array([0.0, 0.0, values["look_at"]])
    return RigidTransform(RotationMatrix(turn), look_at - distance * forwards)


def _furnish(graph: SceneGraph, source: Any, values: dict[str, Any], generator: np.random.Generator) -> None:
    wide, thick = values["table"], 0.02
    board = Box(wide, wide, thick)
    grey = generator.uniform(0.4, 0.8) * np.ones(3)
    _register(graph, source, board, RigidTransform([0.0, 0.0, -thick / 2]), grey, _ROOM)
    floor = RigidTransform([0.0, 0.0, -values["table_height"]])
    _register(graph, source, Box(8.0, 8.0, thick), floor, np.array([0.5, 0.5, 0.5]), _ROOM)


def _register(
    graph: SceneGraph, source: Any, shape: Any, pose: RigidTransform, colour: Array, label: int
) -> None:
    instance = GeometryInstance(pose, shape, f"shape {label} {pose.translation()}")
    perceived = PerceptionProperties()
    perceived.AddProperty(
        "phong", "diffuse", MakePhongIllustrationProperties([*colour, 1.0]).GetProperty("phong", "diffuse")
    )
    perceived.AddProperty("label", "id", RenderLabel(label))
    instance.set_perception_properties(perceived)
    graph.RegisterAnchoredGeometry(source, instance)


def _things(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    wanted = int(generator.integers(values["fewest"], values["most"] + 1))
    makers = (_tin, _box, _ball, _lying, _stack, _rod, _leaning_rod, _pipe)
    things: list[_Thing] = []
    places: list[tuple[Array, float]] = []
    while wanted > 0:
        made = makers[int(generator.integers(len(makers)))](values, generator)
        reach = max(thing.footprint for thing in made)
        for _ in range(_TRIES):
            at = generator.uniform(-1.0, 1.0, 2) * (values["spread"])
            if all(np.linalg.norm(at - other) > reach + taken + values["gap"] for other, taken in places):
                places.append((at, reach))
                shift = RigidTransform([*at, 0.0])
                things += [_Thing(t.kind, t.shape, shift @ t.pose, t.footprint) for t in made]
                break
        wanted -= 1
    return things


def _upright(height: float) -> RigidTransform:
    return RigidTransform([0.0, 0.0, height / 2])


def _tin(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    radius, height = generator.uniform(*values["tin_radius"]), generator.uniform(*values["tin_height"])
    return [_Thing("tin", Cylinder(radius, height), _upright(height), radius)]


def _box(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    smallest, largest = values["box_size"]
    size = generator.uniform(smallest, largest, 3)
    turn = RotationMatrix.MakeZRotation(generator.uniform(0.0, np.pi))
    pose = RigidTransform(turn, [0.0, 0.0, size[2] / 2])
    return [_Thing("box", Box(*size), pose, 0.5 * float(np.hypot(*size[:2])))]


def _ball(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    radius = generator.uniform(*values["ball_radius"])
    return [_Thing("ball", Sphere(radius), _upright(2 * radius), radius)]


def _lying(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    radius, height = generator.uniform(*values["tin_radius"]), generator.uniform(*values["tin_height"])
    turn = RollPitchYaw(0.0, np.pi / 2, generator.uniform(0.0, np.pi)).ToRotationMatrix()
    return [
        _Thing(
            "lying tin",
            Cylinder(radius, height),
            RigidTransform(turn, [0, 0, radius]),
            float(np.hypot(radius, height / 2)),
        )
    ]


def _stack(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    (lower,) = _box(values, generator)
    radius = values["stacked"] * 0.5 * min(lower.shape.width(), lower.shape.depth())
    height, below = generator.uniform(*values["tin_height"]), lower.shape.height()
    pose = RigidTransform([0.0, 0.0, below + height / 2])
    return [lower, _Thing("tin on box", Cylinder(radius, height), pose, lower.footprint)]


def _rod(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    radius, height = generator.uniform(*values["rod_radius"]), generator.uniform(*values["rod_length"])
    return [_Thing("rod", Cylinder(radius, height), _upright(height), radius)]


def _leaning_rod(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    radius, height = generator.uniform(*values["rod_radius"]), generator.uniform(*values["rod_length"])
    lean = RollPitchYaw(0.0, generator.uniform(0.2, 0.9), generator.uniform(-np.pi, np.pi)).ToRotationMatrix()
    up = lean.matrix()[2, 2] * height / 2 + radius * np.sqrt(1.0 - lean.matrix()[2, 2] ** 2)
    return [_Thing("leaning rod", Cylinder(radius, height), RigidTransform(lean, [0.0, 0.0, up]), 2 * radius)]


def _pipe(values: dict[str, Any], generator: np.random.Generator) -> list[_Thing]:
    radius, height = workcell_entries()["pipe"]["radius"], generator.uniform(*values["rod_length"])
    return [_Thing("pipe", Cylinder(radius, height), _upright(height), radius)]
