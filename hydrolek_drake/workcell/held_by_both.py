"""A rigid pipe in two elastic grips: the internal force between the hands.

The pipe has no inertia. Each grip is a linear spring between hand and pipe, made of the contact of its four fixed
fingers, two for each direction across the pipe: with the contact's normal stiffness k, its tangential stiffness k_t,
the fingers' distance d from the hand's middle along the pipe and the pipe's radius r

    across 2 k,  along 4 k_t,  tilting 2 k d^2,  turning about the axis 4 k_t r^2.

Both are free of force where the second hand took the pipe. From then on, with the hands off their hold by the small
displacement delta (six numbers at the pipe's middle), the pipe lies where both springs agree, and what passes from one
hand through the pipe to the other is w = (C_1 + C_2)^-1 delta, C being the compliances at the pipe's middle.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RotationMatrix

from hydrolek_drake.workcell.fingers import FIXED, fingers
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries

Array = NDArray[np.float64]
Pose = tuple[Array, Array]
"""Rotation matrix (3, 3) and position in m (3,)."""


@dataclass(frozen=True)
class HeldByBoth:
    """What is to be remembered of two hands that took a pipe; poses of the right one before those of the left one.

    Attributes:
        pipe: In each hand, when the second one took it.
        along: Where each hand holds it, along the axis from the pipe's middle, in m.
        radius: Of the pipe in m.
    """

    pipe: tuple[Pose, Pose]
    along: tuple[float, float]
    radius: float

    @cached_property
    def compliances(self) -> Array:
        """Of both grips at the pipe's middle, in its frame: displacement and turn for force and moment, (2, 6, 6)."""
        return np.array([self._compliance(along) for along in self.along])

    @cached_property
    def stiffness(self) -> Array:
        """Of both grips one behind the other, shape (6, 6)."""
        return np.asarray(np.linalg.inv(self.compliances.sum(axis=0)), dtype=float)

    def _compliance(self, along: float) -> Array:
        values = workcell_entries()["contact"]
        aside = float(
            np.mean(
                [abs(each.ends[0, 2]) for each in fingers("right") if each.link == FIXED and each.ends[0, 2]]
            )
        )
        normal, tangential = values["stiffness"], values["tangential"]
        tilt, turn = 2.0 * normal * aside**2, 4.0 * tangential * self.radius**2
        own = np.diag([2.0 * normal, 2.0 * normal, 4.0 * tangential, tilt, tilt, turn])
        # a displacement of the middle moves the grip, `along` beyond it on the axis, by u + theta x a
        to_grip = np.eye(6)
        to_grip[:3, 3:] = -_cross([0.0, 0.0, along])
        return np.asarray(np.linalg.inv(to_grip.T @ own @ to_grip), dtype=float)

    def places(self, hands: tuple[Pose, Pose]) -> tuple[Pose, Pose]:
        """Where the pipe would be if each hand had it alone, world frame."""
        right, left = (
            (turned @ inside, here + turned @ offset)
            for (turned, here), (inside, offset) in zip(hands, self.pipe, strict=True)
        )
        return right, left

    def internal(
        self, hands: tuple[Pose, Pose], rates: tuple[Array, Array], damping_time: float
    ) -> tuple[Array, Array, Pose]:
        """What the left hand does to the pipe; the right one does the opposite.

        Args:
            hands: Poses, world frame.
            rates: Of each hand's own pipe at its middle: velocity in m/s, then angular velocity in rad/s; (6,) each.
            damping_time: Damping over stiffness in s.

        Returns:
            Force in N and moment in N m about the pipe's middle, world frame, and the pipe's pose.
        """
        (turn, at), (other, there) = self.places(hands)
        frame = np.kron(np.eye(2), turn)  # from the pipe's frame to the world
        log = RotationMatrix(other @ turn.T).ToAngleAxis()
        delta = frame.T @ np.concatenate([there - at, log.angle() * log.axis()])
        rate = frame.T @ (rates[1] - rates[0])
        wrench = self.stiffness @ (delta + damping_time * rate)
        shift = self.compliances[0] @ self.stiffness @ delta  # of the pipe in the right hand
        small = _cross(shift[3:])
        nearest = RotationMatrix.ProjectToRotationMatrix(turn @ (np.eye(3) + small)).matrix()
        passed = frame @ wrench
        return passed[:3], passed[3:], (nearest, at + turn @ shift[:3])

    def friction_used(self, force: Array, moment: Array, axis: Array, normal: float) -> float:
        """Share of the friction mu F of a grip that holds along the axis and about it; above 1 it would slip.

        Args:
            force: In N.
            moment: In N m.
            axis: Of the pipe.
            normal: Sum F of the normal forces of a grip in N.
        """
        size = float(np.hypot(force @ axis, moment @ axis / self.radius))
        return (
            size / (float(workcell_entries()["loose_pipe"]["friction"]) * normal) if normal > 0.0 else np.inf
        )


def take(pipe: Pipe, hands: tuple[Pose, Pose]) -> HeldByBoth:
    """Both hands on a pipe, with no force between them yet."""
    inside = tuple((turned.T @ pipe.rotation(), turned.T @ (pipe.point - here)) for turned, here in hands)
    along = tuple(float((here - pipe.point) @ pipe.axis) for _, here in hands)
    return HeldByBoth((inside[0], inside[1]), (along[0], along[1]), pipe.radius)


def _cross(vector: Array | list[float]) -> Array:
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
