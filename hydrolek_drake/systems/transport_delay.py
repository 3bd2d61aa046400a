"""Transport delay of the command, exact although the diagram runs in steps."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.command import drive_voltage, transport_delay
from hydrolek_drake.physics.probes import COMMAND
from hydrolek_drake.systems.short_law import Outside

_MOST_STEPS = 10_000


def whole_steps_and_rest(joints: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Each joint's delay as a number of steps and a share of one more, shape (n,) each.

    Raises:
        InputError: a delay below zero, or of more steps than the diagram can hold as its state.
    """
    delays = np.empty(len(joints))
    _delays(joints, delays)
    if not delays.min() >= 0.0:
        raise InputError(
            f"command.delay and what effects add to it are {delays.min():g} s; nothing arrives early"
        )
    if not delays.max() <= _MOST_STEPS * step:
        raise InputError(
            f"command.delay: {delays.max():g} s are more than {_MOST_STEPS} steps of {step:g} s; a dead time is shorter"
        )
    whole = np.floor(delays / step + 1e-9).astype(int)
    rest = delays / step - whole
    return whole, np.where(rest > 1e-9, rest, 0.0)


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
    outside: np.ndarray,
    line: np.ndarray,
    out: np.ndarray,
) -> None:
    """Write this step's commands into the ring `line` (steps times n, its row) and read the delayed voltages."""
    n = len(joints)
    length, newest = (len(line) - 1) // n, int(line[-1])
    for i in range(n):
        line[newest * n + i] = command[i]
        added = outside[i, COMMAND]
        newer = drive_voltage(line[((newest - whole[i]) % length) * n + i] + added, joints[i])
        older = drive_voltage(line[((newest - whole[i] - 1) % length) * n + i] + added, joints[i])
        out[i] = newer + rest[i] * (older - newer)
    line[-1] = (newest + 1) % length


@njit(cache=True)
def _arriving(
    joints: np.ndarray,
    command: np.ndarray,
    whole: np.ndarray,
    outside: np.ndarray,
    line: np.ndarray,
    out: np.ndarray,
) -> None:
    n = len(joints)
    length, newest = (len(line) - 1) // n, int(line[-1])
    for i in range(n):
        arrived = command[i] if whole[i] == 0 else line[((newest - whole[i]) % length) * n + i]
        out[i] = drive_voltage(arrived + outside[i, COMMAND], joints[i])


class TransportDelay(LeafSystem):
    """Delays each joint's command and turns it into the amplifier's voltage (thesis 6.1.3).

    The command is sampled at every step and held; before the first one has arrived nothing is driven. A delay of so
    many steps and a rest lets a sample arrive that rest after a step's beginning.

    Ports:
        in `command` (n): recorded or commanded voltage [V].
        in `outside` (15 n): what a law adds to the command that has arrived, or open.
        out `voltage_delayed` (n): at the amplifiers, positive towards chamber A, limited; its mean over the
            running step [V].
        out `voltage_arriving` (n): the sample that arrives within the step that begins now [V], for what is
            updated at its beginning.
    """

    def __init__(self, joints: np.ndarray, step: float):
        """Build for the joints' records, shape (n,), and the diagram's step [s]."""
        super().__init__()
        self.set_name("transport_delay")
        n = len(joints)
        self._joints = joints
        self._whole, self._rest = whole_steps_and_rest(joints, step)
        self._length = int(self._whole.max()) + 2
        self.command = self.DeclareVectorInputPort("command", n)
        self._none = np.zeros(n)
        self.outside = Outside(self, n)
        # one group: each that an update asks for costs as much as its work
        self._line = self.DeclareDiscreteState(
            np.append(np.tile(joints["command"]["neutral"], self._length), 0.0)
        )
        self._out = self.DeclareDiscreteState(np.zeros(n))
        self.DeclarePeriodicDiscreteUpdateEvent(step, 0.0, self._update)
        self.voltage = self.DeclareStateOutputPort("voltage_delayed", self._out)
        self._at_once = bool(np.any(self._whole == 0))
        self.arriving = self.DeclareVectorOutputPort(
            "voltage_arriving",
            n,
            self._calc_arriving,
            prerequisites_of_calc={self.discrete_state_ticket(self._line), self.outside.port.ticket()}
            | ({self.command.ticket()} if self._at_once else set()),
        )

    def _update(self, context: Context, values: DiscreteValues) -> None:
        _take_in(
            self._joints,
            self.command.Eval(context),
            self._whole,
            self._rest,
            self.outside.eval(context),
            values.get_mutable_value(self._line),
            values.get_mutable_value(self._out),
        )

    def _calc_arriving(self, context: Context, output: BasicVector) -> None:
        _arriving(
            self._joints,
            self.command.Eval(context) if self._at_once else self._none,
            self._whole,
            self.outside.eval(context),
            context.get_discrete_state().get_value(self._line),
            output.get_mutable_value(),
        )
