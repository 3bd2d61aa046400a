"""Contact of both grippers' hands and fingers with a fixed pipe, as forces on the simulated machine."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pydrake.common.value import AbstractValue, Value
from pydrake.math import RollPitchYaw
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.kinematics.arms import arms_urdf_path
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries

Array = NDArray[np.float64]

_MOVING, _FIXED = "jaw", "link6"
_NO_TORQUE = np.zeros(3)


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
        for part in (_FIXED, _MOVING):
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


class GripContact(LeafSystem):
    """Normal forces between a pipe that does not give way and the grippers; no friction.

    Each box of a gripper is a rod with round ends. Where one is nearer to the pipe's axis than both radii, it is
    pushed away along the shortest way between them, by F = k d (1 + c d') with the depth d (Hunt and Crossley 1975);
    never pulled.

    Ports:
        in `plant_state` (all positions and velocities of the plant).
        out `contact_force`: list of forces on bodies, for the plant's `applied_spatial_force`.
        out `grip_force` (2): on the right and the left gripper's moving finger [N].
    """

    def __init__(self, plant: MultibodyPlant, pipe: Pipe) -> None:
        super().__init__()
        self.set_name("grip_contact")
        self._plant, self._pipe = plant, pipe
        values = workcell_entries()["contact"]
        self._stiffness, self._damping = float(values["stiffness"]), float(values["damping"])
        self._reach = float(values["reach"])
        self.fingers = [(side, finger) for side in SIDES for finger in fingers(side)]
        self._own = plant.CreateDefaultContext()
        self._sides = [
            (
                plant.GetBodyByName(f"{side}_{_FIXED}"),
                [self._part(side, link) for link in (_FIXED, _MOVING)],
            )
            for side in SIDES
        ]
        self._templates = []
        for side, finger in self.fingers:
            force = ExternallyAppliedSpatialForce()
            force.body_index = plant.GetBodyByName(f"{side}_{finger.link}").index()
            self._templates.append(force)
        self.plant_state = self.DeclareVectorInputPort("plant_state", plant.num_multibody_states())
        self.contact_force = self.DeclareAbstractOutputPort(
            "contact_force",
            lambda: Value[list[ExternallyAppliedSpatialForce]](),
            self._calc_force,
            prerequisites_of_calc={self.plant_state.ticket()},
        )
        self.grip_force = self.DeclareVectorOutputPort(
            "grip_force", len(SIDES), self._calc_grip, prerequisites_of_calc={self.plant_state.ticket()}
        )

    def _part(self, side: str, link: str) -> tuple[RigidBody, slice, Array, Array]:
        """A link, where its fingers stand in `self.fingers`, their ends and radii."""
        places = [
            index
            for index, (owner, finger) in enumerate(self.fingers)
            if (owner, finger.link) == (side, link)
        ]
        chosen = slice(places[0], places[-1] + 1)
        own = [finger for _, finger in self.fingers[chosen]]
        ends, radii = np.array([finger.ends for finger in own]), np.array([finger.radius for finger in own])
        return self._plant.GetBodyByName(f"{side}_{link}"), chosen, ends, radii

    def touches(self, state: Array) -> tuple[Array, Array]:
        """Where each finger of `self.fingers` is pushed.

        Args:
            state: Of the plant, positions and velocities.

        Returns:
            Points in the fingers' links' frames in m, and forces in the world frame in N, each of shape (n, 3).
        """
        points, forces = np.zeros((len(self.fingers), 3)), np.zeros((len(self.fingers), 3))
        self._plant.SetPositionsAndVelocities(self._own, state)
        for hand, parts in self._sides:
            pose = self._plant.EvalBodyPoseInWorld(self._own, hand)
            if np.linalg.norm(_square_to(self._pipe, pose.translation() - self._pipe.point)) > self._reach:
                continue
            for body, chosen, ends, radii in parts:
                pose = self._plant.EvalBodyPoseInWorld(self._own, body)
                velocity = self._plant.EvalBodySpatialVelocityInWorld(self._own, body)
                _touch(
                    ends,
                    radii,
                    pose.rotation().matrix(),
                    pose.translation() - self._pipe.point,
                    velocity.rotational(),
                    velocity.translational(),
                    self._pipe.axis,
                    self._pipe.radius,
                    0.5 * self._pipe.length,
                    self._stiffness,
                    self._damping,
                    points[chosen],
                    forces[chosen],
                )
        return points, forces

    def _calc_force(self, context: Context, output: AbstractValue) -> None:
        points, pushes = self.touches(self.plant_state.Eval(context))
        forces = []
        for index in np.flatnonzero(pushes.any(axis=1)):
            force = self._templates[index]
            force.p_BoBq_B = points[index]
            force.F_Bq_W = SpatialForce(_NO_TORQUE, pushes[index])
            forces.append(force)
        output.set_value(forces)

    def _calc_grip(self, context: Context, output: BasicVector) -> None:
        _, pushes = self.touches(self.plant_state.Eval(context))
        sizes = np.linalg.norm(pushes, axis=1)
        for place, side in enumerate(SIDES):
            moving = [owner == side and finger.link == _MOVING for owner, finger in self.fingers]
            output[place] = float(sizes[moving].sum())


@njit(cache=True)
def _touch(
    ends: Array,
    radii: Array,
    rotation: Array,
    origin: Array,
    turning: Array,
    sliding: Array,
    axis: Array,
    radius: float,
    half_length: float,
    stiffness: float,
    damping: float,
    points: Array,
    forces: Array,
) -> None:
    """Points and forces of one link's fingers; `origin` is the link's from the middle of the pipe."""
    for i in range(len(radii)):
        first = rotation @ ends[i, 0]
        way = rotation @ ends[i, 1] - first
        from_pipe = origin + first
        square = from_pipe - np.dot(from_pipe, axis) * axis
        across = way - np.dot(way, axis) * axis
        length = np.dot(across, across)
        share = min(max(-np.dot(square, across) / length, 0.0), 1.0) if length > 0.0 else 0.0
        nearest = square + share * across
        distance = np.sqrt(np.dot(nearest, nearest))
        depth = radius + radii[i] - distance
        arm = first + share * way
        if depth <= 0.0 or distance == 0.0 or abs(np.dot(origin + arm, axis)) > half_length:
            continue
        normal = nearest / distance
        outwards = np.dot(normal, sliding + np.cross(turning, arm))
        forces[i] = stiffness * depth * max(0.0, 1.0 - damping * outwards) * normal
        points[i] = rotation.T @ arm


def _square_to(pipe: Pipe, vector: Array) -> Array:
    """The part of a vector that is square to the pipe's axis."""
    return vector - (vector @ pipe.axis) * pipe.axis


def _numbers(text: str | None) -> Array:
    return np.array([float(word) for word in (text or "").split()])
