"""A simulated operator who moves one joint after the other by joystick rate control (thesis 5.4)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.teleop.operator_model import Operator, operator_entries, preparation, reaction_time
from hydrolek_drake.teleop.stick_rates import StickRates

Array = NDArray[np.float64]

_SHARES = (
    1.0,
    0.5,
    0.25,
)  # of the way to its goal that a joint is moved, where not all of it is seen to be free

_LEARNS = 2.0  # most that one short press changes what the next one is expected to do


@dataclass(frozen=True)
class Goal:
    """A posture that the operator wants.

    Attributes:
        posture: Joints in rad, shape (n,).
        levers: How far the tool goes with each joint in m/rad, shape (n,).
        tolerance: How near is enough, in m at the tool: root of the sum of squares over the joints.
        until_still: Whether a joint is moved until it stands still, as a jaw that closes on something.
        free: Whether nothing is seen in the way between two postures; any way is free if not given.
    """

    posture: Array
    levers: Array
    tolerance: float
    until_still: bool = False
    free: Callable[[Array, Array], bool] = lambda first, second: True


@dataclass
class Move:
    """One deflection of one joint's stick.

    Attributes:
        joint: Which, from 0.
        began: Time in s.
        start: The joint's angle then in rad.
        aim: Where it is to come, in rad.
        percent: Deflection.
        speed: Expected with it, in rad/s.
        by_sight: Whether the stick is let go by sight; else after a time that was fixed before.
        let_go: When it is let go, in s; None while that is open.
        stuck: Whether it was let go because the joint stood still.
    """

    joint: int
    began: float
    start: float
    aim: float
    percent: float
    speed: float
    by_sight: bool
    let_go: float | None = None
    stuck: bool = False


class JoystickOperator:
    """Looks, decides, reaches for the stick of one joint, deflects it, lets go, waits until the arm stands still.

    The operator knows the wanted posture of every joint and how fast the joints go, and sees their angles. Of the
    joints, that one is moved next which brings the tool farthest on its way, all of it or a part, as far as it is seen
    to be free. A joint that has just come short comes last.

    Every move is aimed with an error that is a share of its length. A long move is ended by sight, a reaction time
    late, for which the operator allows, and for the machine's dead time if it is known. A move shorter than a reaction
    is a press whose length was fixed before; what it did is learned for the next one of this joint in this direction. A
    deflection with which a joint stood still before it came half the way is not tried again, and how fast a joint is
    seen to go is learned, too.

    Args:
        operator: Who it is.
        goals: Postures to be reached one after the other.
        rates: What is known of the joints.
        generator: For the aiming error.
    """

    def __init__(
        self, operator: Operator, goals: Sequence[Goal], rates: StickRates, generator: np.random.Generator
    ) -> None:
        self._operator, self._goals, self._rates = operator, list(goals), rates
        self._generator = generator
        self._human, self._hand = operator_entries("human"), operator_entries("hand")
        self._reaction = operator.pace * reaction_time()
        self._known = rates.dead_time if operator.knows_dead_time else np.zeros(len(rates.dead_time))
        self._learned = np.ones((len(rates.dead_time), 2))
        self._faster = np.ones((len(rates.dead_time), 2))  # speeds seen over those that were expected
        self._in_vain = np.zeros((len(rates.dead_time), 2))  # percent that did not move a joint
        self._goal, self._next, self._last, self._share = 0, -1, -1, 1.0
        self._ready: float | None = None  # when the hand is at the next stick
        self._move: Move | None = None
        self._blocked = -1  # joint whose last move came short
        self._learned_from = 0  # moves whose outcome has been seen
        self._seen: list[tuple[float, Array]] = []
        self.moves: list[Move] = []
        self.unseen_ways = 0  # moves for which no way was seen to be free

    @property
    def goal(self) -> int:
        """Number of the goal that is worked at, from 0."""
        return self._goal

    @property
    def finished(self) -> bool:
        """Whether all goals have been reached."""
        return self._goal >= len(self._goals)

    @property
    def thinking_until(self) -> float | None:
        """When the hand will be at the next stick, in s, while the arm stands still and the operator thinks."""
        return self._ready

    def deflection(self, time: float, position: ArrayLike) -> Array:
        """What the sticks do now.

        Args:
            time: In s, rising from call to call.
            position: Joints in rad, shape (n,).

        Returns:
            Deflections in percent, shape (n,); one of them at most is not zero.
        """
        here = np.array(position, dtype=float)
        self._look(time, here)
        sticks = np.zeros(len(here))
        if self.finished:
            return sticks
        if self._move is None:
            if self._ready is None and self._still():
                self._decide(time, here)
            if not self.finished and self._ready is not None and time >= self._ready:
                self._begin(time, here)
        if self._move is not None:
            self._watch(time, here, self._move)
            if self._move.let_go is not None and time >= self._move.let_go:
                self._move = None
                if self._goals[self._goal].until_still:
                    self._goal += 1
            else:
                sticks[self._move.joint] = self._move.percent
        return sticks

    def _look(self, time: float, here: Array) -> None:
        cycle = self._human["perceptual_cycle"]
        self._seen = [each for each in self._seen if each[0] >= time - cycle - 1e-9]
        self._seen.append((time, here))

    def _speed(self) -> Array:
        """As seen over a perceptual cycle, in rad/s."""
        (first, before), (last, now) = self._seen[0], self._seen[-1]
        return (now - before) / (last - first) if last > first else np.zeros(len(now))

    def _still(self) -> bool:
        if self._seen[-1][0] - self._seen[0][0] < 0.9 * self._human["perceptual_cycle"]:
            return False
        levers = self._goals[self._goal].levers
        return bool(np.max(levers * np.abs(self._seen[-1][1] - self._seen[0][1])) < self._hand["still"])

    def _decide(self, time: float, here: Array) -> None:
        """Choose the next joint, or the next goal; sets when the hand is at the stick."""
        self._learn(here)
        while not self.finished:
            goal = self._goals[self._goal]
            errors = goal.levers * np.abs(goal.posture - here)
            if float(np.linalg.norm(errors)) > goal.tolerance:
                break
            self._goal += 1
        if self.finished:
            return
        worth_moving = errors >= goal.tolerance / np.sqrt(
            len(errors)
        )  # one is, as the root of the sum is above
        self._next, self._share = self._choose(goal, here, np.where(worth_moving, errors, 0.0))
        if self._next == self._last:
            self._ready = time + self._reaction
        else:
            self._ready = time + preparation(self._operator, 2 * int(worth_moving.sum()))

    def _choose(self, goal: Goal, here: Array, errors: Array) -> tuple[int, float]:
        """The joint whose free way, or part of it, brings most; and which share of its way."""
        order = [int(joint) for joint in np.argsort(-errors) if errors[joint] > 0.0]
        order.sort(key=lambda joint: joint == self._blocked)  # what has just been in vain comes last
        best, chosen = 0.0, (order[0], 1.0)
        for joint in order:
            for share in _SHARES:
                if errors[joint] * share <= best:
                    break
                there = here.copy()
                there[joint] += share * (goal.posture[joint] - here[joint])
                if goal.free(here, there):
                    best, chosen = errors[joint] * share, (joint, share)
                    break
        self.unseen_ways += int(best == 0.0)
        return chosen

    def _begin(self, time: float, here: Array) -> None:
        goal, joint = self._goals[self._goal], self._next
        self._ready, self._last = None, joint
        wanted = self._share * (goal.posture[joint] - here[joint])
        aimed = wanted * (1.0 + self._human["error_share"] * self._generator.standard_normal())
        sign = 1.0 if aimed > 0.0 else -1.0
        side = (joint, int(sign > 0.0))
        percent, speed = self._rates.smallest(
            joint,
            sign,
            abs(aimed) / self._hand["move_time"] / self._faster[side],
            self._operator.most_deflection,
            self._in_vain[side],
        )
        speed *= self._faster[side]
        holding = abs(aimed) / (speed * self._learned[side])
        move = Move(joint, time, here[joint], here[joint] + aimed, sign * percent, speed, True)
        if not goal.until_still and holding < self._reaction + self._known[joint]:
            move.by_sight = False
            move.let_go = time + max(holding, self._human["motor_cycle"])
        self._move = move
        self.moves.append(move)

    def _watch(self, time: float, here: Array, move: Move) -> None:
        """Decide by sight when to let go; the hand does it a reaction time later."""
        if move.let_go is not None:
            return
        joint, sign = move.joint, np.sign(move.percent)
        speed = float(self._speed()[joint] * sign)
        left = (move.aim - here[joint]) * sign
        begun = time - move.began > self._rates.dead_time[joint] + 2.0 * self._human["perceptual_cycle"]
        if begun and self._still():  # it has come to an end, or does not move at all
            move.let_go, move.stuck = time + self._reaction, True
        elif not self._goals[self._goal].until_still:
            early = self._reaction + float(self._known[joint])
            if left <= max(speed, 0.0) * early:
                move.let_go = time + self._reaction

    def _learn(self, here: Array) -> None:
        """How far the last press came, against what was expected of it."""
        if self._learned_from == len(self.moves):
            return
        self._learned_from, move = len(self.moves), self.moves[-1]
        side = (move.joint, int(move.percent > 0.0))
        moved = here[move.joint] - move.start
        self._blocked = move.joint if abs(moved) < 0.5 * abs(move.aim - move.start) else -1
        if not move.by_sight:
            self._learned[side] *= np.clip(moved / (move.aim - move.start), 1.0 / _LEARNS, _LEARNS)
        elif move.stuck and abs(moved) < 0.5 * abs(move.aim - move.start):
            self._in_vain[side], self._learned[side] = abs(move.percent), 1.0
        elif move.let_go is not None and not move.stuck:
            took = max(move.let_go - move.began - float(self._rates.dead_time[move.joint]), self._reaction)
            self._faster[side] *= np.clip(abs(moved) / took / move.speed, 1.0 / _LEARNS, _LEARNS)
