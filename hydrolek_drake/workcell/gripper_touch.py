"""Where a pipe pushes the hands and fingers of both grippers, as the plant stands and moves."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import RigidBody

from hydrolek_drake.compiled import read_only
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.workcell.contact_kernel import touch
from hydrolek_drake.workcell.fingers import FIXED, MOVING, fingers
from hydrolek_drake.workcell.held_by_both import Pose
from hydrolek_drake.workcell.loose_pipe import LoosePipe
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries

Array = NDArray[np.float64]

_NO_TORQUE = np.zeros(3)


class GripperTouch:
    """Both grippers of one plant, each box of them as a rod with round ends.

    Where one is nearer to the pipe's axis than both radii, it is pushed away along the shortest way between them, by
    F = k d (1 + c d') with the depth d (Hunt and Crossley 1975); never pulled.

    Args:
        plant: With the arms.

    Attributes:
        fingers: (side, finger) of every box.
        stiffness: k, in N/m.
        damping: c, in s/m.
    """

    def __init__(self, plant: MultibodyPlant) -> None:
        values = workcell_entries()["contact"]
        self.stiffness, self.damping = float(values["stiffness"]), float(values["damping"])
        self._reach = float(values["reach"])
        self.fingers = [(side, finger) for side in SIDES for finger in fingers(side)]
        self._links = [plant.GetBodyByName(f"{side}_{finger.link}") for side, finger in self.fingers]
        self._plant, self._own = plant, plant.CreateDefaultContext()
        self._sides = [
            (
                plant.GetBodyByName(f"{side}_{FIXED}"),
                [self._part(side, link) for link in (FIXED, MOVING)],
            )
            for side in SIDES
        ]
        self._jaws = {side: plant.GetJointByName(f"{side}_j7") for side in SIDES}

    def _part(self, side: str, link: str) -> tuple[RigidBody, slice, Array, Array]:
        """A link, where its fingers stand in `self.fingers`, their ends and radii."""
        places = np.flatnonzero(self.of(side, link))
        chosen = slice(places[0], places[-1] + 1)
        own = [finger for _, finger in self.fingers[chosen]]
        ends, radii = np.array([finger.ends for finger in own]), np.array([finger.radius for finger in own])
        return self._plant.GetBodyByName(f"{side}_{link}"), chosen, ends, radii

    def of(self, side: str, link: str) -> NDArray[np.bool_]:
        """Which of `fingers` belong to a link, `fingers.MOVING` or `fingers.FIXED`, of a side."""
        return np.array([(owner, finger.link) == (side, link) for owner, finger in self.fingers])

    def stand(self, state: Array) -> None:
        """Both grippers stand and move so, for all that is asked afterwards.

        Args:
            state: Of the plant, positions and velocities.
        """
        self._plant.SetPositionsAndVelocities(self._own, state)

    def hands(self) -> list[Pose]:
        """Of the right and the left gripper."""
        poses = [self._plant.EvalBodyPoseInWorld(self._own, hand) for hand, _ in self._sides]
        return [(pose.rotation().matrix(), np.array(pose.translation())) for pose in poses]

    def opens(self, side: str) -> bool:
        """Whether the jaw of a side is opening."""
        return bool(self._jaws[side].get_angular_rate(self._own) > 0.0)

    def velocities_at(self, points: tuple[Array, Array]) -> tuple[Array, Array]:
        """Of points that the right and the left hand carry: along in m/s and turning in rad/s, of shape (6,) each."""
        rates = []
        for (hand, _), point in zip(self._sides, points, strict=True):
            velocity = self._plant.EvalBodySpatialVelocityInWorld(self._own, hand)
            arm = point - self._plant.EvalBodyPoseInWorld(self._own, hand).translation()
            sliding = velocity.translational() + np.cross(velocity.rotational(), arm)
            rates.append(np.concatenate([sliding, velocity.rotational()]))
        return rates[0], rates[1]

    def pushes(self, loose: LoosePipe) -> tuple[Array, Array]:
        """Where each of `fingers` is pushed.

        Args:
            loose: The pipe.

        Returns:
            Points in the fingers' links' frames in m, and forces in the world frame in N, each of shape (n, 3).
        """
        points, forces = np.zeros((len(self.fingers), 3)), np.zeros((len(self.fingers), 3))
        hands = self.hands()
        pipe = loose.now(hands)
        with_both = () if loose.both is None else loose.both.places((hands[0], hands[1]))
        for index, (side, (hand, parts)) in enumerate(zip(SIDES, self._sides, strict=True)):
            holds = loose.holder == side or bool(with_both)
            if with_both:
                # each hand's fingers press the pipe as that hand took it; the rest is in its spring
                turned, point = with_both[index]
                pipe = replace(pipe, point=point, axis=np.array(turned[:, 2]))
            pose = self._plant.EvalBodyPoseInWorld(self._own, hand)
            if np.linalg.norm(_square_to(pipe, pose.translation() - pipe.point)) > self._reach:
                continue
            carried = self._plant.EvalBodySpatialVelocityInWorld(self._own, hand)
            for body, chosen, ends, radii in parts:
                place = self._plant.EvalBodyPoseInWorld(self._own, body)
                velocity = self._plant.EvalBodySpatialVelocityInWorld(self._own, body)
                turning, sliding = velocity.rotational(), velocity.translational()
                if holds:  # the pipe moves with the hand; only the moving finger moves against it
                    if body is hand:
                        continue
                    turning = turning - carried.rotational()
                    arm = place.translation() - pose.translation()
                    sliding = sliding - carried.translational() - np.cross(carried.rotational(), arm)
                touch(
                    ends,
                    radii,
                    place.rotation().matrix(),
                    place.translation() - pipe.point,
                    read_only(turning),
                    read_only(sliding),
                    pipe.axis,
                    pipe.radius,
                    0.5 * pipe.length,
                    self.stiffness,
                    self.damping,
                    points[chosen],
                    forces[chosen],
                )
        return points, forces

    def on_finger(self, index: int, point: Array, push: Array) -> ExternallyAppliedSpatialForce:
        """A force on one of `fingers`, at a point in its link's frame."""
        return _applied(self._links[index], point, push, _NO_TORQUE)

    def on_hand_at_finger(self, index: int, point: Array, push: Array) -> ExternallyAppliedSpatialForce:
        """A force on the hand of one of `fingers`, at a point in the frame of that finger's link."""
        where = self._plant.EvalBodyPoseInWorld(self._own, self._links[index]).multiply(point)
        return self.on_hand(self.fingers[index][0], where, push)

    def on_hand(
        self, side: str, point: Array, push: Array, twist: Array = _NO_TORQUE
    ) -> ExternallyAppliedSpatialForce:
        """A force and a moment on a hand at a point of the world."""
        hand = self._sides[SIDES.index(side)][0]
        there = self._plant.EvalBodyPoseInWorld(self._own, hand).inverse().multiply(point)
        return _applied(hand, there, push, twist)


def _applied(body: RigidBody, point: Array, push: Array, twist: Array) -> ExternallyAppliedSpatialForce:
    force = ExternallyAppliedSpatialForce()
    force.body_index = body.index()
    force.p_BoBq_B = point
    force.F_Bq_W = SpatialForce(twist, push)
    return force


def _square_to(pipe: Pipe, vector: Array) -> Array:
    """The part of a vector that is square to the pipe's axis."""
    return vector - (vector @ pipe.axis) * pipe.axis
