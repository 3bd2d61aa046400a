"""Transport delay of the command, exact in the mean although the diagram runs in steps."""

import numpy as np
from numba import njit
from pydrake.systems.framework import Context, LeafSystem, State

from hydrolek_drake.physics.command import drive_voltage, transport_delay


@njit(cache=True)
def _delays(joints: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(joints)):
        out[i] = transport_delay(joints[i])


@njit(cache=True)
def _take_in(
    joints: np.ndarray,
    command: np.ndarray,
    whole: np.ndarray,
    rest: np.ndarray,
    row: np.ndarray,
    line: np.ndarray,
    out: np.ndarray,
) -> None:
    """Write this step's voltages into the ring `line` (steps times n) and read the delayed ones from it."""
    n = len(joints)
    length = len(line) // n
    newest = int(row[0])
    for i in range(n):
        line[newest * n + i] = drive_voltage(command[i], joints[i])
        newer = line[((newest - whole[i]) % length) * n + i]
        older = line[((newest - whole[i] - 1) % length) * n + i]
        out[i] = newer + rest[i] * (older - newer)
    row[0] = (newest + 1) % length


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
        self.command = self.DeclareVectorInputPort("command", n)
        self._row = self.DeclareDiscreteState(np.zeros(1))
        self._line = self.DeclareDiscreteState(np.zeros(self._length * n))
        self._out = self.DeclareDiscreteState(np.zeros(n))
        self.DeclareInitializationUnrestrictedUpdateEvent(self._fill)
        # Unrestricted updates come before discrete ones at the same time, so the spool sees this step's voltage.
        self.DeclarePeriodicUnrestrictedUpdateEvent(step, 0.0, self._update)
        self.voltage = self.DeclareStateOutputPort("voltage_delayed", self._out)

    def _fill(self, context: Context, state: State) -> None:
        """Before the start the first command stood."""
        for _ in range(self._length):
            self._update(context, state)

    def _update(self, context: Context, state: State) -> None:
        values = state.get_mutable_discrete_state()
        _take_in(
            self._joints,
            self.command.Eval(context),
            self._whole,
            self._rest,
            values.get_mutable_value(self._row),
            values.get_mutable_value(self._line),
            values.get_mutable_value(self._out),
        )
