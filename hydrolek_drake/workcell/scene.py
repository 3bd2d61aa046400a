"""Arms, room and pipe as one Drake diagram: for the simulated camera and for collision checks."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.geometry import (
    Box,
    Cylinder,
    LightParameter,
    MakeRenderEngineVtk,
    Meshcat,
    RenderEngineVtkParams,
    SceneGraph,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, SpatialInertia, default_model_instance
from pydrake.systems.framework import Diagram, DiagramBuilder

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import add_arms, arm_joint_names, position_indices
from hydrolek_drake.workcell.pipe import Pipe, home_angles, workcell_entries
from hydrolek_drake.workcell.table import Table

RENDERER = "vtk"

_THICK = 0.02  # m, of floor and wall


@dataclass(frozen=True)
class Scene:
    """The finished diagram and what is in it.

    Attributes:
        diagram: Holds the arms' plant and the scene graph, and nothing that moves by itself.
        plant: The arms, with pipe and room fixed to the world.
        scene_graph: Shapes, collisions, renderer.
        order: Index of each joint `right_j1` ... `left_j7` in the plant's positions, shape (14,).
        pipe: What is in the scene, or None.
        pipe_frame: The pipe's place, a frame whose pose is a parameter of the Context; None without a pipe.
    """

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    order: list[int]
    pipe: Pipe | None
    pipe_frame: Any = None

    def positions(self, angles: Any) -> Any:
        """The plant's position vector for joints `right_j1` ... `left_j7` in rad, shape (14,).

        Raises:
            InputError: Not 14 finite angles.
        """
        angles = np.asarray(angles, dtype=float)
        if angles.shape != (len(self.order),) or not np.isfinite(angles).all():
            raise InputError(f"angles have shape {angles.shape}; give {len(self.order)} finite ones in rad")
        positions = np.zeros(self.plant.num_positions())
        positions[self.order] = angles
        return positions


def home_posture() -> Any:
    """Joints `right_j1` ... `left_j7` of the posture that a task starts from, in rad, shape (14,)."""
    return np.concatenate([home_angles("right"), home_angles("left")])


def make_scene(
    pipe: Pipe | None, *, rendered: bool, meshcat: Meshcat | None = None, table: Table | None = None
) -> Scene:
    """Arms, floor, wall, pipe and table.

    Args:
        pipe: The pipe, or None for none.
        table: What it stands on, or None.
        rendered: Whether a renderer for the camera is added.
        meshcat: Browser view to show the scene in, if any.
    """
    builder = DiagramBuilder()
    frames: list[Any] = []
    arms = add_arms(
        builder,
        time_step=0.0,
        meshcat=meshcat,
        before_finalize=lambda plant: frames.append(_furnish(plant, pipe, table)),
    )
    if rendered:
        add_renderer(arms.scene_graph)
    diagram = builder.Build()
    diagram.set_name("workcell")
    order = position_indices(arms.plant, list(arm_joint_names()))
    return Scene(diagram, arms.plant, arms.scene_graph, order, pipe, frames[0])


def add_renderer(scene_graph: SceneGraph) -> None:
    """Drake's VTK renderer, which needs no screen, under the name `RENDERER`, with the room's lamps."""
    room = workcell_entries()["room"]
    lamps = [
        LightParameter(type="point", position=position, frame="world", intensity=room["lamp_intensity"])
        for position in room["lamps"]
    ]
    scene_graph.AddRenderer(RENDERER, MakeRenderEngineVtk(RenderEngineVtkParams(lights=lamps)))


def _furnish(plant: MultibodyPlant, pipe: Pipe | None, table: Table | None) -> Any:
    """Floor, wall, table and pipe; returns the frame of the pipe."""
    room = workcell_entries()["room"]
    world, friction = plant.world_body(), CoulombFriction()
    floor = RigidTransform([0.0, 0.0, -_THICK / 2])
    plant.RegisterVisualGeometry(world, floor, Box(8.0, 8.0, _THICK), "floor", [*room["floor_colour"], 1.0])
    wall = RigidTransform([room["wall_distance"] + _THICK / 2, 0.0, 1.25])
    plant.RegisterVisualGeometry(world, wall, Box(_THICK, 8.0, 2.5), "wall", [*room["wall_colour"], 1.0])
    if table is not None:
        board = RigidTransform(table.top - [0.0, 0.0, 0.5 * table.thickness])
        colour = [*workcell_entries()["table"]["colour"], 1.0]
        plant.RegisterVisualGeometry(world, board, Box(*table.size, table.thickness), "table", colour)
    if pipe is None:
        return None
    pose = RigidTransform(RotationMatrix(pipe.rotation()), pipe.point)
    frame = plant.AddFrame(FixedOffsetFrame("pipe_place", world, pose))
    body = plant.AddRigidBody("pipe", default_model_instance(), SpatialInertia.Zero())
    plant.WeldFrames(frame, body.body_frame())
    shape, colour = Cylinder(pipe.radius, pipe.length), workcell_entries()["pipe"]["colour"]
    plant.RegisterVisualGeometry(body, RigidTransform(), shape, "pipe", [*colour, 1.0])
    plant.RegisterCollisionGeometry(body, RigidTransform(), shape, "pipe", friction)
    return frame
