"""A pipe that can be carried: it stands, follows the hand that grips it, or falls.

Kinematic: no force moves the pipe. Not held, it stands like a rock on what carries it; held, it is part of the hand;
held by both, it lies where their grips agree (`held_by_both`); let go, it falls straight down with the attitude that it
has and stops on the table, or on the floor.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.tree import UniformGravityFieldElement

from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.workcell.held_by_both import HeldByBoth, Pose, take
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]

GRAVITY = float(UniformGravityFieldElement.kDefaultStrength)  # m/s^2


@dataclass(frozen=True)
class LoosePipe:
    """What is to be remembered of such a pipe.

    Attributes:
        pipe: Where it is, world frame; while it is held, where it was when the hand took it.
        holder: `right`, `left`, or empty.
        taken: Pose of the hand when it took the pipe; None while nobody holds it.
        falling: Speed downwards in m/s.
        both: How both hands have it; None while at most one holds it.
    """

    pipe: Pipe
    holder: str = ""
    taken: Pose | None = None
    falling: float = 0.0
    both: HeldByBoth | None = None

    def now(self, hands: Sequence[Pose]) -> Pipe:
        """Where the pipe is while the hands (right, left) are there."""
        if self.taken is None:
            return self.pipe
        if self.both is not None:
            right, left = hands
            still = np.zeros(6)
            turn, point = self.both.internal((right, left), (still, still), 0.0)[2]
            return replace(self.pipe, point=point, axis=np.array(turn[:, 2]))
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
            if both == (self.both is not None):
                return self
            if both:
                right, left = hands
                return replace(self, both=take(pipe, (right, left)))
            return LoosePipe(pipe, self.holder, hands[SIDES.index(self.holder)])
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
