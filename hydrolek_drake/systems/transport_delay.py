"""Transport delay of the command, exact in the mean although the diagram runs in steps."""

import numpy as np
from numba import njit
from pydrake.systems.framework import Context, DiscreteValues, LeafSystem, State

from hydrolek_drake.physics.command import drive_voltage, transport_delay


@njit(cache=True)
def _delays(joints: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(joints)):
        out[i] = transport_delay(joints[i])


@njit(cache=True)
def _shift(joints: np.ndarray, line: np.ndarray, command: np.ndarray, out: np.ndarray) -> None:
    """The line of past voltages moved on by one step, the newest first; shapes (steps, n)."""
    for i in range(len(joints)):
        out[0, i] = drive_voltage(command[i], joints[i])
        for k in range(1, len(line)):
            out[k, i] = line[k - 1, i]


class TransportDelay(LeafSystem):
    """Delays each joint's command and turns it into the amplifier's voltage (thesis 6.1.3).

    The command is sampled at every step and held. The output is the mean of the delayed command over the
    running step, so a delay that is no multiple of the step is met exactly in the integral of the voltage.

    Ports:
        in `command` (n): recorded or commanded voltage [V].
        out `voltage_delayed` (n): at the amplifiers, positive towards chamber A, limited [V].
    """

    def __init__(self, joints: np.ndarray, step: float):
        """Build for the joints' records, shape (n,), and the diagram's step [s]."""
        super().__init__()
        self.set_name("transport_delay")
        n = len(joints)
        self._joints = joints
        delays = np.empty(n)
        _delays(joints, delays)
        self._whole = np.floor(delays / step + 1e-9).astype(int)
        self._rest = np.maximum(delays / step - self._whole, 0.0)
        self._length = int(self._whole.max()) + 2
        self._columns = np.arange(n)
        self.command = self.DeclareVectorInputPort("command", n)
        self._line = self.DeclareDiscreteState(np.zeros(self._length * n))
        self._out = self.DeclareDiscreteState(np.zeros(n))
        self.DeclareInitializationDiscreteUpdateEvent(self._fill)
        # Unrestricted updates come before discrete ones at the same time, so the spool sees this step's voltage.
        self.DeclarePeriodicUnrestrictedUpdateEvent(step, 0.0, self._update)
        self.voltage = self.DeclareStateOutputPort("voltage_delayed", self._out)

    def _fill(self, context: Context, values: DiscreteValues) -> None:
        """Before the start the first command stood."""
        line = np.zeros((self._length, len(self._joints)))
        for _ in range(self._length):
            moved = np.empty_like(line)
            _shift(self._joints, line, self.command.Eval(context), moved)
            line = moved
        values.get_mutable_vector(self._line).SetFromVector(line.ravel())
        values.get_mutable_vector(self._out).SetFromVector(line[0])

    def _update(self, context: Context, state: State) -> None:
        line = context.get_discrete_state(self._line).get_value().reshape(self._length, -1)
        moved = np.empty_like(line)
        _shift(self._joints, line, self.command.Eval(context), moved)
        state.get_mutable_discrete_state(self._line).SetFromVector(moved.ravel())
        newer = moved[self._whole, self._columns]
        older = moved[self._whole + 1, self._columns]
        state.get_mutable_discrete_state(self._out).SetFromVector(newer + self._rest * (older - newer))
