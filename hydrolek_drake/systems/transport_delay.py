"""Transport delay of the command, exact to the moment although the diagram runs in steps."""

from collections import deque

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context, LeafSystem, State

from hydrolek_drake.physics.command import drive_voltage, transport_delay


class TransportDelay(LeafSystem):
    """Delays each joint's command and turns it into the amplifier's voltage (thesis 6.1.3).

    At every step it puts out the mean of the delayed command over the coming step, so a delay that is no
    multiple of the step is still met exactly in the integral of the voltage.

    Ports:
        in `command` (n): recorded or commanded voltage [V].
        out `voltage_delayed` (n): at the amplifiers, positive towards chamber A, limited [V].
    """

    def __init__(self, joints: np.ndarray, step: float):
        """Build for the joints' records, shape (n,), and the diagram's step [s]."""
        super().__init__()
        self.set_name("transport_delay")
        self._joints = joints
        self._step = step
        self._delays = [transport_delay(joint) for joint in joints]
        self.command = self.DeclareVectorInputPort("command", len(joints))
        self._held = self.DeclareDiscreteState(np.zeros(len(joints)))
        # Per joint the changes of the command that the amplifier has not yet seen: (time, voltage).
        self._history = self.DeclareAbstractState(AbstractValue.Make([deque() for _ in joints]))
        self.DeclarePeriodicUnrestrictedUpdateEvent(step, 0.0, self._update)
        self.voltage = self.DeclareVectorOutputPort(
            "voltage_delayed", len(joints), self._calc, prerequisites_of_calc={self.xd_ticket()}
        )

    def _update(self, context: Context, state: State) -> None:
        now = context.get_time()
        command = self.command.Eval(context)
        histories = [deque(h) for h in context.get_abstract_state(self._history).get_value()]
        held = np.empty(len(histories))
        for i, history in enumerate(histories):
            voltage = drive_voltage(command[i], self._joints[i])
            if not history:
                history.append((-np.inf, voltage))  # before the start the first command stood
            if voltage != history[-1][1]:
                history.append((now, voltage))
            held[i] = self._mean(history, now - self._delays[i])
        state.get_mutable_abstract_state(self._history).set_value(histories)
        state.get_mutable_discrete_state(self._held).SetFromVector(held)

    def _mean(self, history: "deque[tuple[float, float]]", begin: float) -> float:
        """Mean of the command over [begin, begin + step]; drops what lies before."""
        tiny = 1e-9 * self._step
        while len(history) > 1 and history[1][0] <= begin + tiny:
            history.popleft()
        end = begin + self._step
        total, since, voltage = 0.0, begin, history[0][1]
        for change, following in list(history)[1:]:
            if change >= end - tiny:
                break
            total += voltage * (change - since)
            since, voltage = change, following
        return (total + voltage * (end - since)) / self._step

    def _calc(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(self._held).get_value())
