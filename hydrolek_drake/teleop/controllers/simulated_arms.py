"""Arms that follow set points as the thesis's closed loops do: dead time, first order lag, speed limit.

A stand-in for controllers and hydraulics with the same interface, fast enough for any browser session; it has no
pressures, no voltages and no load. With the valves closed the joints stand still.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.systems.framework import Context, EventStatus, LeafSystem, State

from hydrolek_drake.kinematics.chain import SIDES, joint_limits
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.workcell.trajectory import joint_speeds

Array = NDArray[np.float64]

_JOINTS = 14


class SimulatedArms(LeafSystem):
    """q' = limited((delayed set point - q) / time constant), q within the joint limits; zero with closed valves.

    ```
    position_desired ---> +---------------+
         valves_open ---> | SimulatedArms | ---> position_measured
                          +---------------+
    ```

    Inputs: `position_desired`, joints `right_j1` ... `left_j7` in rad (14); `valves_open`, 1 or 0 (1).
    Output: `position_measured` in rad (14), state alone.
    """

    def __init__(self, posture: ArrayLike, period: float) -> None:
        super().__init__()
        self.set_name("simulated_arms")
        values = teleop_entries("arms")
        self._period, self._lag = period, values["time_constant"]
        self._speed = joint_speeds()[0] * values["speed_reserve"]
        limits = [joint_limits(side) for side in SIDES]
        self._lower, self._upper = (np.concatenate([each[i] for each in limits]) for i in (0, 1))
        self._delay = max(1, round(values["dead_time"] / period))
        start = np.asarray(posture, dtype=float)
        self.position_desired_input = self.DeclareVectorInputPort("position_desired", _JOINTS)
        self.valves_open_input = self.DeclareVectorInputPort("valves_open", 1)
        self._position = self.DeclareDiscreteState(start)
        self._queue = self.DeclareDiscreteState(np.tile(start, self._delay))
        self.position_measured_output = self.DeclareStateOutputPort("position_measured", self._position)
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, 0.0, self._update)

    def _update(self, context: Context, state: State) -> EventStatus:
        position = np.array(context.get_discrete_state(self._position).value())
        queue = np.array(context.get_discrete_state(self._queue).value()).reshape(self._delay, _JOINTS)
        if self.valves_open_input.Eval(context)[0] > 0.5:
            share = 1.0 - np.exp(-self._period / self._lag)
            step = np.clip(
                share * (queue[0] - position), -self._speed * self._period, self._speed * self._period
            )
            position = np.clip(position + step, self._lower, self._upper)
            queue = np.vstack([queue[1:], self.position_desired_input.Eval(context)])
        else:
            queue = np.tile(position, (self._delay, 1))
        state.get_mutable_discrete_state(self._position).SetFromVector(position)
        state.get_mutable_discrete_state(self._queue).SetFromVector(queue.ravel())
        return EventStatus.Succeeded()
