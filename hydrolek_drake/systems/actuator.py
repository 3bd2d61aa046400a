"""The actuators of every joint: cylinders, the vane of joint 4, the motor of joint 6, the gripper's cylinder.

They are the same two chambers with other displacements (see `physics.cylinder`), so one vector system
serves them all; the record's variant tells them apart.
"""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, ContinuousState, LeafSystem

from hydrolek_drake.physics.cavity import pressures
from hydrolek_drake.physics.cylinder import pressure_force, pressure_rates
from hydrolek_drake.physics.driven import INPUTS
from hydrolek_drake.physics.fluid import softened
from hydrolek_drake.physics.probes import CAPACITY_A, CAPACITY_B, CYLINDER
from hydrolek_drake.physics.rod_friction import bent_on, bent_rate, friction_force
from hydrolek_drake.systems.recorded import Recorded
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _rates(
    joints: np.ndarray,
    pressure: np.ndarray,
    flow: np.ndarray,
    motion: np.ndarray,
    outside: np.ndarray,
    out: np.ndarray,
) -> None:
    n = len(joints)
    for i in range(n):
        rate_a, rate_b, stiff_a, stiff_b = pressure_rates(
            pressure[i], pressure[n + i], flow[i], flow[n + i], motion[i], motion[n + i], joints[i]
        )
        out[i], _ = softened(outside[i, CAPACITY_A], rate_a, stiff_a)
        out[n + i], _ = softened(outside[i, CAPACITY_B], rate_b, stiff_b)


@njit(cache=True)
def _told(joints: np.ndarray, state: np.ndarray, out: np.ndarray) -> None:
    n = len(joints)
    for i in range(n):
        out[i], out[n + i] = pressures(state[i], state[n + i], joints[i])


@njit(cache=True)
def _bristle_rates(
    joints: np.ndarray, bent: np.ndarray, motion: np.ndarray, ahead: float, out: np.ndarray
) -> None:
    n = len(joints)
    for i in range(n):
        v = motion[n + i]
        if ahead > 0.0:  # with which an Euler step is exact where a body slides: it would run away otherwise
            out[i] = (bent_on(bent[i], v * ahead, ahead, joints[i]) - bent[i]) / ahead
        else:
            out[i] = bent_rate(bent[i], v, joints[i])


@njit(cache=True)
def _forces(
    joints: np.ndarray,
    pressure: np.ndarray,
    bent: np.ndarray,
    flow: np.ndarray,
    motion: np.ndarray,
    outside: np.ndarray,
    time: float,
    ahead: float,
    out: np.ndarray,
) -> None:
    n = len(joints)
    for i in range(n):
        joint = joints[i]
        v = motion[n + i]
        held = bent_on(bent[i], v * ahead, ahead, joint)
        friction, _, _ = friction_force(motion[i], v, held, ahead, time, joint)
        p_a, p_b = pressure[i], pressure[n + i]
        if ahead > 0.0 and joint.driven.chamber_pressures <= 0.0:
            rate_a, rate_b, stiff_a, stiff_b = pressure_rates(
                p_a, p_b, flow[i], flow[n + i], motion[i], motion[n + i], joint
            )
            p_a += ahead * softened(outside[i, CAPACITY_A], rate_a, stiff_a)[0]
            p_b += ahead * softened(outside[i, CAPACITY_B], rate_b, stiff_b)[0]
        p_a, p_b = pressures(p_a, p_b, joint)
        out[i] = pressure_force(p_a, p_b, joint) - friction + outside[i, CYLINDER]


class Actuator(LeafSystem):
    """Oil flow to chamber pressures and rod force, equation (4.9).

    Ports:
        in `oil_flow` (3n) [m^3/s].
        in `rod_motion` (2n): strokes [m], then velocities [m/s]; angles for vane and motor.
        in `outside` (15 n): what a law adds, or open.
        out `pressure` (2n): chambers A, then B [Pa]; the continuous state, with none where it tells of
            a cavity; beside it for each joint the share of its rod's dry friction that bristles hold.
        out `rod_force` (n): positive pushes out [N]; moments [N m] for vane and motor.
    """

    def __init__(self, joints: np.ndarray, ahead: float, recorded: Recorded | None = None):
        """Build for the joints' records.

        Args:
            joints: shape (n,).
            ahead: the force belongs to the pressures this much later [s]. One step for an explicit Euler
                integrator, which this turns into the symplectic one: stable for oil springs where the plain
                one is not. Zero for any other integrator.
            recorded: what was recorded, where it drives joints; pressures take the place of these.
        """
        super().__init__()
        self.set_name("actuator")
        self._ahead = ahead
        n = len(joints)
        self._joints = joints
        self._no_flow = np.zeros(3 * n)
        self._driven = joints["driven"]["chamber_pressures"] > 0.0
        self._recorded = recorded if self._driven.any() else None
        self.flow = self.DeclareVectorInputPort("oil_flow", 3 * n)
        self.motion = self.DeclareVectorInputPort("rod_motion", 2 * n)
        self.outside = Outside(self, n)
        self.DeclareContinuousState(BasicVector(3 * n))
        self.pressure = self.DeclareVectorOutputPort(
            "pressure",
            2 * n,
            self._calc_pressure,
            {self.xc_ticket(), self.time_ticket()} if self._recorded else {self.xc_ticket()},
        )
        self.force = self.DeclareVectorOutputPort(
            "rod_force",
            n,
            self._calc_force,
            prerequisites_of_calc={
                self.xc_ticket(),
                self.time_ticket(),
                self.motion.ticket(),
                self.outside.port.ticket(),
            }
            | ({self.flow.ticket()} if ahead > 0.0 else set()),
        )

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Continuity of the oil in both chambers."""
        n = len(self._joints)
        rates = np.empty(3 * n)
        pressure = self._pressures(context, 0.0)
        _rates(
            self._joints,
            pressure,
            self.flow.Eval(context),
            self.motion.Eval(context),
            self.outside.eval(context),
            rates,
        )
        if self._recorded:
            rates[: 2 * n][np.tile(self._driven, 2)] = 0.0
        _bristle_rates(
            self._joints, self._bent(context), self.motion.Eval(context), self._ahead, rates[2 * n :]
        )
        derivatives.SetFromVector(rates)

    def rest(self, context: Context, pressures: np.ndarray) -> None:
        """Begin with chambers at these pressures [Pa] and no bristle bent. # (n, 2)."""
        context.SetContinuousState(np.concatenate([pressures.T.ravel(), np.zeros(len(self._joints))]))

    def _bent(self, context: Context) -> np.ndarray:
        state: np.ndarray = context.get_continuous_state_vector().CopyToVector()
        return state[2 * len(self._joints) :]

    def _pressures(self, context: Context, ahead: float) -> np.ndarray:
        """Pressures of the chambers, those that are recorded so much later [s]. # (2n,)."""
        pressure: np.ndarray = context.get_continuous_state_vector().CopyToVector()[: 2 * len(self._joints)]
        if self._recorded:
            rows = self._recorded.at(context.get_time() + ahead)
            both = np.concatenate([rows[:, place] for place in INPUTS["chamber_pressures"]])
            driven = np.tile(self._driven, 2)
            pressure[driven] = both[driven]
        return pressure

    def _calc_pressure(self, context: Context, output: BasicVector) -> None:
        _told(self._joints, self._pressures(context, 0.0), output.get_mutable_value())

    def _calc_force(self, context: Context, output: BasicVector) -> None:
        pressure = self._pressures(context, self._ahead)
        flow = self.flow.Eval(context) if self._ahead > 0.0 else self._no_flow
        motion = self.motion.Eval(context)
        force = output.get_mutable_value()
        outside = self.outside.eval(context)
        _forces(
            self._joints,
            pressure,
            self._bent(context),
            flow,
            motion,
            outside,
            context.get_time(),
            self._ahead,
            force,
        )
