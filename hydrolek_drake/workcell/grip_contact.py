"""Contact of both grippers' hands and fingers with a pipe, clamped or loose, as forces on the simulated machine."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import AbstractValue, Value
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import BasicVector, Context, LeafSystem, State

from hydrolek_drake.compiled import read_only
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.workcell.contact_kernel import touch
from hydrolek_drake.workcell.fingers import FIXED, MOVING, fingers
from hydrolek_drake.workcell.held_by_both import Pose
from hydrolek_drake.workcell.loose_pipe import GRAVITY, LoosePipe
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]

_NO_TORQUE = np.zeros(3)


class GripContact(LeafSystem):
    """Normal forces between a pipe and the grippers.

    Each box of a gripper is a rod with round ends. Where one is nearer to the pipe's axis than both radii, it is
    pushed away along the shortest way between them, by F = k d (1 + c d') with the depth d (Hunt and Crossley 1975);
    never pulled.

    A clamped pipe does not give way. A loose one (where there is a table) does not either until a gripper holds it:
    until moving and fixed fingers press so hard that friction on both carries its weight, 2 mu F >= m g, while the jaw
    does not open (one that has just let go swings a little and would take it again). Held, it moves with the hand as
    one body: the moving finger's force acts on the hand with opposite sign, and its weight at its middle; its inertia
    is left out. What lets go of it drops it (`loose_pipe.LoosePipe`).

    Both grippers on a loose pipe close a chain: what is off in their joints passes through the pipe from hand to hand,
    by the springs of `held_by_both`, with damping as in the contact, c times the force over the stiffness. Until it
    holds too, a second gripper finds a pipe that does not give way, as a clamped one; the force between the hands
    counts from there.

    Ports:
        in `plant_state` (all positions and velocities of the plant).
        out `contact_force`: list of forces on bodies, for the plant's `applied_spatial_force`.
        out `grip_force` (2): on the right and the left gripper's moving finger [N].
        out `pipe_place` (6): middle of the pipe in m and its axis, world frame.
        out `internal_force` (7): of the left hand on a pipe that both hold, world frame: force [N], moment about the
            pipe's middle [N m]; the larger share of the grips' friction that is used [1]. Else zeros.
    """

    def __init__(self, plant: MultibodyPlant, pipe: Pipe, table: Table | None = None) -> None:
        super().__init__()
        self.set_name("grip_contact")
        self._plant, self._table = plant, table
        loose = workcell_entries()["loose_pipe"]
        self._weight = float(loose["mass"]) * GRAVITY
        self._carries = self._weight / (2.0 * float(loose["friction"]))
        self._period = float(loose["follow"])
        self._first = LoosePipe(pipe)
        self._loose = self.DeclareAbstractState(Value[object](self._first))
        if table is not None:
            self.DeclarePeriodicUnrestrictedUpdateEvent(self._period, 0.0, self._follow)
        values = workcell_entries()["contact"]
        self._stiffness, self._damping = float(values["stiffness"]), float(values["damping"])
        self._reach = float(values["reach"])
        self.fingers = [(side, finger) for side in SIDES for finger in fingers(side)]
        self._own = plant.CreateDefaultContext()
        self._sides = [
            (
                plant.GetBodyByName(f"{side}_{FIXED}"),
                [self._part(side, link) for link in (FIXED, MOVING)],
            )
            for side in SIDES
        ]
        self._jaws = {side: plant.GetJointByName(f"{side}_j7") for side in SIDES}
        self._templates = []
        for side, finger in self.fingers:
            force = ExternallyAppliedSpatialForce()
            force.body_index = plant.GetBodyByName(f"{side}_{finger.link}").index()
            self._templates.append(force)
        self.plant_state = self.DeclareVectorInputPort("plant_state", plant.num_multibody_states())
        needed = {self.plant_state.ticket(), self.abstract_state_ticket(self._loose)}
        self.contact_force = self.DeclareAbstractOutputPort(
            "contact_force",
            lambda: Value[list[ExternallyAppliedSpatialForce]](),
            self._calc_force,
            prerequisites_of_calc=needed,
        )
        self.grip_force = self.DeclareVectorOutputPort(
            "grip_force", len(SIDES), self._calc_grip, prerequisites_of_calc=needed
        )
        self.pipe_place = self.DeclareVectorOutputPort(
            "pipe_place", 6, self._calc_place, prerequisites_of_calc=needed
        )

        self.internal_force = self.DeclareVectorOutputPort(
            "internal_force", 7, self._calc_internal, prerequisites_of_calc=needed
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

    def touches(self, state: Array, loose: LoosePipe | None = None) -> tuple[Array, Array]:
        """Where each finger of `self.fingers` is pushed.

        Args:
            state: Of the plant, positions and velocities.
            loose: The pipe as `pipe_in` a context; where it was at first if not given.

        Returns:
            Points in the fingers' links' frames in m, and forces in the world frame in N, each of shape (n, 3).
        """
        points, forces = np.zeros((len(self.fingers), 3)), np.zeros((len(self.fingers), 3))
        self._plant.SetPositionsAndVelocities(self._own, state)
        loose = self._first if loose is None else loose
        hands = self._hands()
        pipe, with_both = (
            loose.now(hands),
            () if loose.both is None else loose.both.places((hands[0], hands[1])),
        )
        for index, (side, (hand, parts)) in enumerate(zip(SIDES, self._sides, strict=True)):
            holds = loose.holder == side or bool(with_both)
            if (
                with_both
            ):  # each hand's fingers press the pipe as that hand took it; the rest is in its spring
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
                    self._stiffness,
                    self._damping,
                    points[chosen],
                    forces[chosen],
                )
        return points, forces

    def sizes(self, context: Context) -> Array:
        """Force on each finger of `self.fingers` in N, shape (n,)."""
        _, pushes = self.touches(self.plant_state.Eval(context), self.pipe_in(context))
        return np.array(np.linalg.norm(pushes, axis=1))

    def pipe_in(self, context: Context) -> LoosePipe:
        """The pipe as this system's context has it."""
        loose: LoosePipe = context.get_abstract_state(int(self._loose)).get_value()
        return loose

    def _hands(self) -> list[Pose]:
        """Of the plant as it stands in this system's own context."""
        poses = [self._plant.EvalBodyPoseInWorld(self._own, hand) for hand, _ in self._sides]
        return [(pose.rotation().matrix(), np.array(pose.translation())) for pose in poses]

    def _follow(self, context: Context, state: State) -> None:
        assert self._table is not None  # else this is never called
        loose, sizes = self.pipe_in(context), self.sizes(context)
        gripped = []
        for side in SIDES:
            pressed = []
            for part in (MOVING, FIXED):
                mine = [(owner, finger.link) == (side, part) for owner, finger in self.fingers]
                pressed.append(float(sizes[mine].sum()) >= self._carries)
            takes = pressed[1] and self._jaws[side].get_angular_rate(self._own) <= 0.0
            holds = loose.holder == side or loose.both is not None
            gripped.append(pressed[0] and (takes or holds))
        after = loose.step(self._hands(), gripped, self._table, self._period)
        if loose.holder and not after.holder:
            after = self._sprung_off(after, self.plant_state.Eval(context))
        if after is not loose:
            state.get_mutable_abstract_state(int(self._loose)).set_value(after)

    def _sprung_off(self, loose: LoosePipe, state: Array) -> LoosePipe:
        """A pipe that has just been let go, as far aside as the fingers that still stand had been pressed into it.

        It is light and they are stiff: they spring back at once, and push it and not the hand.
        """
        at_rest = np.array(state)
        at_rest[self._plant.num_positions() :] = 0.0
        for _ in self.fingers:  # one after the other, the deepest first
            _, pushes = self.touches(at_rest, loose)
            deepest = pushes[np.argmax(np.linalg.norm(pushes, axis=1))]
            if not deepest.any():
                break
            aside = loose.pipe.moved(np.eye(3), -deepest / self._stiffness)
            loose = replace(loose, pipe=aside)
        return loose

    def _calc_force(self, context: Context, output: AbstractValue) -> None:
        loose = self.pipe_in(context)
        points, pushes = self.touches(self.plant_state.Eval(context), loose)
        forces = []
        for index in np.flatnonzero(pushes.any(axis=1)):
            force = self._templates[index]
            force.p_BoBq_B = points[index]
            force.F_Bq_W = SpatialForce(_NO_TORQUE, pushes[index])
            forces.append(force)
            side = self.fingers[index][0]
            if (
                loose.both is not None or loose.holder == side
            ):  # what the finger presses, the hand holds against
                finger = self._sides[SIDES.index(side)][1][1][0]
                where = self._plant.EvalBodyPoseInWorld(self._own, finger).multiply(points[index])
                forces.append(self._on_hand(side, where, -pushes[index]))
        if loose.both is not None:
            push, twist, (_, middle) = self._internal(loose, pushes)
            half = np.array([0.0, 0.0, -0.5 * self._weight])  # as both grips are alike
            forces.append(self._on_hand("right", middle, push + half, twist))
            forces.append(self._on_hand("left", middle, half - push, -twist))
        elif loose.holder:
            middle = loose.now(self._hands()).point
            forces.append(self._on_hand(loose.holder, middle, np.array([0.0, 0.0, -self._weight])))
        output.set_value(forces)

    def _internal(self, loose: LoosePipe, pushes: Array) -> tuple[Array, Array, Pose]:
        """What the left hand does to a pipe that both hold; the plant as in this system's own context."""
        assert loose.both is not None  # else this is not called
        right, left = self._hands()
        rates = []
        for (hand, _), (_, middle) in zip(self._sides, loose.both.places((right, left)), strict=True):
            velocity = self._plant.EvalBodySpatialVelocityInWorld(self._own, hand)
            arm = middle - self._plant.EvalBodyPoseInWorld(self._own, hand).translation()
            sliding = velocity.translational() + np.cross(velocity.rotational(), arm)
            rates.append(np.concatenate([sliding, velocity.rotational()]))
        damping_time = self._damping * self._pressed(pushes) / self._stiffness
        return loose.both.internal((right, left), (rates[0], rates[1]), damping_time)

    def _pressed(self, pushes: Array) -> float:
        """The smaller force of both moving fingers in N."""
        sizes = np.linalg.norm(pushes, axis=1)
        moving = [
            [owner == side and finger.link == MOVING for owner, finger in self.fingers] for side in SIDES
        ]
        return float(min(sizes[each].sum() for each in moving))

    def _calc_internal(self, context: Context, output: BasicVector) -> None:
        loose = self.pipe_in(context)
        if loose.both is None:
            output.SetFromVector(np.zeros(7))
            return
        _, pushes = self.touches(self.plant_state.Eval(context), loose)
        force, moment, (turned, _) = self._internal(loose, pushes)
        normal = 2.0 * self._pressed(pushes)  # the fixed fingers press as much as the moving one
        share = loose.both.friction_used(force, moment, turned[:, 2], normal)
        output.SetFromVector([*force, *moment, share])

    def _on_hand(
        self, side: str, point: Array, push: Array, twist: Array = _NO_TORQUE
    ) -> ExternallyAppliedSpatialForce:
        """A force and a moment on a hand at a point of the world."""
        hand = self._sides[SIDES.index(side)][0]
        force = ExternallyAppliedSpatialForce()
        force.body_index = hand.index()
        force.p_BoBq_B = self._plant.EvalBodyPoseInWorld(self._own, hand).inverse().multiply(point)
        force.F_Bq_W = SpatialForce(twist, push)
        return force

    def _calc_grip(self, context: Context, output: BasicVector) -> None:
        sizes = self.sizes(context)
        for place, side in enumerate(SIDES):
            moving = [owner == side and finger.link == MOVING for owner, finger in self.fingers]
            output[place] = float(sizes[moving].sum())

    def _calc_place(self, context: Context, output: BasicVector) -> None:
        self._plant.SetPositionsAndVelocities(self._own, self.plant_state.Eval(context))
        pipe = self.pipe_in(context).now(self._hands())
        output.SetFromVector([*pipe.point, *pipe.axis])


def _square_to(pipe: Pipe, vector: Array) -> Array:
    """The part of a vector that is square to the pipe's axis."""
    return vector - (vector @ pipe.axis) * pipe.axis
