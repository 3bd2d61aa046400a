"""Electric motors with their drives in place of the hydraulic chain."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, ContinuousState, LeafSystem

from hydrolek_drake.physics.cylinder import SERVO_SCREW, follows_position, motor_current, motor_force
from hydrolek_drake.physics.linkages.servo_screw import at_rest, driven
from hydrolek_drake.physics.sensor import current_reading


@njit(cache=True)
def _forces(
    joints: np.ndarray,
    voltage: np.ndarray,
    motion: np.ndarray,
    memory: np.ndarray,
    out: np.ndarray,
    rates: np.ndarray,
) -> None:
    """Forces [N], and the rates of what the drives remember: the integrals of the positions' errors, then speeds'."""
    n = len(joints)
    for i in range(n):
        rates[i] = rates[n + i] = 0.0
        if follows_position(joints[i]):
            out[i], _, rates[i], rates[n + i] = driven(
                voltage[i], motion[i], motion[n + i], memory[i], memory[n + i], joints[i]
            )
        else:
            out[i] = motor_force(voltage[i], joints[i])


@njit(cache=True)
def _currents(
    joints: np.ndarray, voltage: np.ndarray, motion: np.ndarray, memory: np.ndarray, out: np.ndarray
) -> None:
    n = len(joints)
    for i in range(n):
        current = motor_current(voltage[i], motion[i], motion[n + i], memory[i], memory[n + i], joints[i])
        out[i] = current_reading(current, joints[i])


@njit(cache=True)
def _resting(joints: np.ndarray, force: np.ndarray, out: np.ndarray) -> None:
    n = len(joints)
    for i in range(n):
        out[i] = out[n + i] = 0.0
        if follows_position(joints[i]):
            out[i], out[n + i] = at_rest(force[i], joints[i])


class ElectricMotor(LeafSystem):
    """Voltage to force; of a drive that follows a position also what that makes of the nut's motion.

    Ports:
        in `voltage_delayed` (n) [V].
        in `rod_motion` (2n): positions of the nuts, then velocities [m, m/s]; open where no drive follows a position.
        out `rod_force` (n) [N].
        out `motor_current` (n): as the sensors read it [A].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("electric_motor")
        n = len(joints)
        self._joints = joints
        self.follows = bool(np.any(joints["cylinder"]["variant"] == SERVO_SCREW))
        self.voltage = self.DeclareVectorInputPort("voltage_delayed", n)
        self.motion = self.DeclareVectorInputPort("rod_motion", 2 * n)
        self._nothing, self._unused = np.zeros(2 * n), np.zeros(2 * n)
        if self.follows:
            self.DeclareContinuousState(2 * n)
        seen = {self.voltage.ticket()}
        if self.follows:
            seen |= {self.motion.ticket(), self.xc_ticket()}
        self.force = self.DeclareVectorOutputPort("rod_force", n, self._calc, prerequisites_of_calc=seen)
        self.current = self.DeclareVectorOutputPort(
            "motor_current", n, self._calc_current, prerequisites_of_calc=seen
        )

    def rest(self, context: Context, force: np.ndarray) -> None:
        """Let the drives have held forces on their nuts [N] for a while. # (n,)."""
        if self.follows:
            memory = np.empty(2 * len(self._joints))
            _resting(self._joints, force, memory)
            context.SetContinuousState(memory)

    def _state(self, context: Context) -> tuple[np.ndarray, np.ndarray]:
        """Motion of the nuts, and what the drives remember. # (2n,), (2n,)."""
        if not self.follows:
            return self._nothing, self._nothing
        return self.motion.Eval(context), context.get_continuous_state_vector().CopyToVector()

    def _calc(self, context: Context, output: BasicVector) -> None:
        motion, memory = self._state(context)
        volts = self.voltage.Eval(context)
        _forces(self._joints, volts, motion, memory, output.get_mutable_value(), self._unused)

    def _calc_current(self, context: Context, output: BasicVector) -> None:
        motion, memory = self._state(context)
        volts = self.voltage.Eval(context)
        _currents(self._joints, volts, motion, memory, output.get_mutable_value())

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Rates of the drives' integrals."""
        if not self.follows:
            return
        motion, memory = self._state(context)
        rates, force = np.empty(len(memory)), np.empty(len(self._joints))
        _forces(self._joints, self.voltage.Eval(context), motion, memory, force, rates)
        derivatives.SetFromVector(rates)
