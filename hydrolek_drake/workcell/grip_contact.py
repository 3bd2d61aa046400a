"""Contact of both grippers' hands and fingers with a pipe, clamped or loose, as forces on the simulated machine."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import AbstractValue, Value
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.systems.framework import BasicVector, Context, LeafSystem, State

from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.workcell.fingers import FIXED, MOVING
from hydrolek_drake.workcell.gripper_touch import GripperTouch
from hydrolek_drake.workcell.held_by_both import Pose
from hydrolek_drake.workcell.loose_pipe import GRAVITY, LoosePipe
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]


class GripContact(LeafSystem):
    """Normal forces between a pipe and the grippers.

    Where a gripper touches the pipe it is pushed as `gripper_touch` has it.

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
        self._table, self._speeds = table, slice(plant.num_positions(), None)
        loose = workcell_entries()["loose_pipe"]
        self._weight = float(loose["mass"]) * GRAVITY
        self._carries = self._weight / (2.0 * float(loose["friction"]))
        self._period = float(loose["follow"])
        self._first = LoosePipe(pipe)
        self._loose = self.DeclareAbstractState(Value[object](self._first))
        if table is not None:
            self.DeclarePeriodicUnrestrictedUpdateEvent(self._period, 0.0, self._follow)
        self._grippers = GripperTouch(plant)
        self.fingers = self._grippers.fingers
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

    def touches(self, state: Array, loose: LoosePipe | None = None) -> tuple[Array, Array]:
        """Where each finger of `self.fingers` is pushed.

        Args:
            state: Of the plant, positions and velocities.
            loose: The pipe as `pipe_in` a context; where it was at first if not given.

        Returns:
            Points in the fingers' links' frames in m, and forces in the world frame in N, each of shape (n, 3).
        """
        self._grippers.stand(state)
        return self._grippers.pushes(self._first if loose is None else loose)

    def sizes(self, context: Context) -> Array:
        """Force on each finger of `self.fingers` in N, shape (n,)."""
        _, pushes = self.touches(self.plant_state.Eval(context), self.pipe_in(context))
        return np.array(np.linalg.norm(pushes, axis=1))

    def pipe_in(self, context: Context) -> LoosePipe:
        """The pipe as this system's context has it."""
        loose: LoosePipe = context.get_abstract_state(int(self._loose)).get_value()
        return loose

    def _follow(self, context: Context, state: State) -> None:
        assert self._table is not None  # else this is never called
        loose, sizes = self.pipe_in(context), self.sizes(context)
        gripped = []
        for side in SIDES:
            pressed = [
                float(sizes[self._grippers.of(side, part)].sum()) >= self._carries for part in (MOVING, FIXED)
            ]
            takes = pressed[1] and not self._grippers.opens(side)
            holds = loose.holder == side or loose.both is not None
            gripped.append(pressed[0] and (takes or holds))
        after = loose.step(self._grippers.hands(), gripped, self._table, self._period)
        if loose.holder and not after.holder:
            after = self._sprung_off(after, self.plant_state.Eval(context))
        if after is not loose:
            state.get_mutable_abstract_state(int(self._loose)).set_value(after)

    def _sprung_off(self, loose: LoosePipe, state: Array) -> LoosePipe:
        """A pipe that has just been let go, as far aside as the fingers that still stand had been pressed into it.

        It is light and they are stiff: they spring back at once, and push it and not the hand.
        """
        at_rest = np.array(state)
        at_rest[self._speeds] = 0.0
        for _ in self.fingers:  # one after the other, the deepest first
            _, pushes = self.touches(at_rest, loose)
            deepest = pushes[np.argmax(np.linalg.norm(pushes, axis=1))]
            if not deepest.any():
                break
            aside = loose.pipe.moved(np.eye(3), -deepest / self._grippers.stiffness)
            loose = replace(loose, pipe=aside)
        return loose

    def _calc_force(self, context: Context, output: AbstractValue) -> None:
        loose = self.pipe_in(context)
        points, pushes = self.touches(self.plant_state.Eval(context), loose)
        grippers, forces = self._grippers, []
        for index in map(int, np.flatnonzero(pushes.any(axis=1))):
            forces.append(grippers.on_finger(index, points[index], pushes[index]))
            if loose.both is not None or loose.holder == self.fingers[index][0]:
                # what the finger presses, the hand holds against
                forces.append(grippers.on_hand_at_finger(index, points[index], -pushes[index]))
        if loose.both is not None:
            push, twist, (_, middle) = self._internal(loose, pushes)
            half = np.array([0.0, 0.0, -0.5 * self._weight])  # as both grips are alike
            forces.append(grippers.on_hand("right", middle, push + half, twist))
            forces.append(grippers.on_hand("left", middle, half - push, -twist))
        elif loose.holder:
            middle = loose.now(grippers.hands()).point
            forces.append(grippers.on_hand(loose.holder, middle, np.array([0.0, 0.0, -self._weight])))
        output.set_value(forces)

    def _internal(self, loose: LoosePipe, pushes: Array) -> tuple[Array, Array, Pose]:
        """What the left hand does to a pipe that both hold; the plant as in this system's own context."""
        assert loose.both is not None  # else this is not called
        right, left = self._grippers.hands()
        (_, at_right), (_, at_left) = loose.both.places((right, left))
        rates = self._grippers.velocities_at((at_right, at_left))
        damping_time = self._grippers.damping * self._pressed(pushes) / self._grippers.stiffness
        return loose.both.internal((right, left), rates, damping_time)

    def _pressed(self, pushes: Array) -> float:
        """The smaller force of both moving fingers in N."""
        sizes = np.linalg.norm(pushes, axis=1)
        return float(min(sizes[self._grippers.of(side, MOVING)].sum() for side in SIDES))

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

    def _calc_grip(self, context: Context, output: BasicVector) -> None:
        sizes = self.sizes(context)
        for place, side in enumerate(SIDES):
            output[place] = float(sizes[self._grippers.of(side, MOVING)].sum())

    def _calc_place(self, context: Context, output: BasicVector) -> None:
        self._grippers.stand(self.plant_state.Eval(context))
        pipe = self.pipe_in(context).now(self._grippers.hands())
        output.SetFromVector([*pipe.point, *pipe.axis])
