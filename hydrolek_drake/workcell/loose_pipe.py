"""A pipe that can be carried: it stands, follows the hand that grips it, or falls.

Kinematic: no force moves the pipe. Not held, it stands like a rock on what carries it; held, it is part of the hand
that took it first, and what a second hand does to it goes on to that one (`grip_contact.GripContact`); let go, it falls
straight down with the attitude that it has and stops on the table, or on the floor.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.tree import UniformGravityFieldElement

from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]
Pose = tuple[Array, Array]
"""Rotation matrix (3, 3) and position in m (3,) of a hand in the world frame."""

GRAVITY = float(UniformGravityFieldElement.kDefaultStrength)  # m/s^2


@dataclass(frozen=True)
class LoosePipe:
    """What is to be remembered of such a pipe.

    Attributes:
        pipe: Where it is, world frame; while it is held, where it was when the hand took it.
        holder: `right`, `left`, or empty.
        taken: Pose of the hand when it took the pipe; None while nobody holds it.
        falling: Speed downwards in m/s.
        second: Place of the other hand against the pipe when that took it too: along the axis in m, about it in rad;
            None while at most one hand holds it.
    """

    pipe: Pipe
    holder: str = ""
    taken: Pose | None = None
    falling: float = 0.0
    second: tuple[float, float] | None = None

    def beside(self, hands: Sequence[Pose]) -> tuple[float, float]:
        """Where the hand that is not the holder's is against the pipe: along its axis in m, about it in rad."""
        (before, _), (turned, _) = self.taken or hands[0], hands[SIDES.index(self.holder)]
        pipe, (rotation, here) = self.now(hands), hands[1 - SIDES.index(self.holder)]
        frame = turned @ before.T @ self.pipe.rotation()  # goes with the pipe
        seen = frame.T @ rotation[:, 0]
        return float((here - pipe.point) @ pipe.axis), float(np.arctan2(seen[1], seen[0]))

    def now(self, hands: Sequence[Pose]) -> Pipe:
        """Where the pipe is while the hands (right, left) are there."""
        if self.taken is None:
            return self.pipe
        (before, there), (turned, here) = self.taken, hands[SIDES.index(self.holder)]
        rotation = turned @ before.T
        return self.pipe.moved(rotation, here - rotation @ there)

    def step(
        self, hands: Sequence[Pose], gripped: Sequence[bool], table: Table, period: float
    ) -> "LoosePipe":
        """After another period: taken, held, let go, falling or at rest.

        Args:
            hands: Poses of the right and the left one.
            gripped: Whether each of them clasps the pipe.
            table: What the pipe can stand on.
            period: In s.
        """
        pipe = self.now(hands)
        if self.holder and gripped[SIDES.index(self.holder)]:
            both = gripped[1 - SIDES.index(self.holder)]
            if both == (self.second is not None):
                return self
            return replace(self, second=self.beside(hands) if both else None)
        for side, hand, grips in zip(SIDES, hands, gripped, strict=True):
            if grips:
                return LoosePipe(pipe, side, hand)
        floor = float(table.top[2]) if table.under(pipe.point) else 0.0
        drop = pipe.lowest() - floor
        if drop <= 0.0:
            return LoosePipe(pipe)
        speed = self.falling + GRAVITY * period
        fallen = min(0.5 * (self.falling + speed) * period, drop)
        resting = fallen == drop
        down = replace(pipe, point=pipe.point - [0.0, 0.0, fallen])
        return LoosePipe(down, falling=0.0 if resting else speed)


def clasped(pipe: Pipe, tool: Array, jaw: float) -> bool:
    """Whether a gripper without contact forces holds a pipe: the tool on its axis, the jaw closed as far as on it.

    Args:
        pipe: Where it is.
        tool: The grasp point between the fingers, world frame in m, shape (3,).
        jaw: Its angle in rad.
    """
    offset = tool - pipe.point
    along = float(offset @ pipe.axis)
    beside = float(np.linalg.norm(offset - along * pipe.axis))
    closed = jaw <= np.radians(workcell_entries()["place"]["touching_deg"])
    return bool(closed and beside < pipe.radius and abs(along) < 0.5 * pipe.length)
