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
from pydrake.systems.framework import Diagram, DiagramBuilder

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import add_arms, arm_joint_names, position_indices
from hydrolek_drake.workcell.pipe import Pipe, home_angles, workcell_entries

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
    """

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    order: list[int]
    pipe: Pipe | None

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


def make_scene(pipe: Pipe | None, *, rendered: bool, meshcat: Meshcat | None = None) -> Scene:
    """Arms, floor, wall and pipe.

    Args:
        pipe: The pipe, or None for none.
        rendered: Whether a renderer for the camera is added.
        meshcat: Browser view to show the scene in, if any.
    """
    builder = DiagramBuilder()
    arms = add_arms(
        builder,
        time_step=0.0,
        meshcat=meshcat,
        before_finalize=lambda plant: _furnish(plant, pipe),
    )
    if rendered:
        add_renderer(arms.scene_graph)
    diagram = builder.Build()
    diagram.set_name("workcell")
    order = position_indices(arms.plant, list(arm_joint_names()))
    return Scene(diagram, arms.plant, arms.scene_graph, order, pipe)


def add_renderer(scene_graph: SceneGraph) -> None:
    """Drake's VTK renderer, which needs no screen, under the name `RENDERER`, with the room's lamps."""
    room = workcell_entries()["room"]
    lamps = [
        LightParameter(type="point", position=position, frame="world", intensity=room["lamp_intensity"])
        for position in room["lamps"]
    ]
    scene_graph.AddRenderer(RENDERER, MakeRenderEngineVtk(RenderEngineVtkParams(lights=lamps)))


def _furnish(plant: MultibodyPlant, pipe: Pipe | None) -> None:
    room = workcell_entries()["room"]
    world, friction = plant.world_body(), CoulombFriction()
    floor = RigidTransform([0.0, 0.0, -_THICK / 2])
    plant.RegisterVisualGeometry(world, floor, Box(8.0, 8.0, _THICK), "floor", [*room["floor_colour"], 1.0])
    wall = RigidTransform([room["wall_distance"] + _THICK / 2, 0.0, 1.25])
    plant.RegisterVisualGeometry(world, wall, Box(_THICK, 8.0, 2.5), "wall", [*room["wall_colour"], 1.0])
    if pipe is not None:
        pose = RigidTransform(RotationMatrix(pipe.rotation()), pipe.point)
        shape, colour = Cylinder(pipe.radius, pipe.length), workcell_entries()["pipe"]["colour"]
        plant.RegisterVisualGeometry(world, pose, shape, "pipe", [*colour, 1.0])
        plant.RegisterCollisionGeometry(world, pose, shape, "pipe", friction)
