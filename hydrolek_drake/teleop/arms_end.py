"""The controllers' end of the link with the simple simulated arms."""

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import Simulator

from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.hand import travel
from hydrolek_drake.teleop.link import SetpointServer
from hydrolek_drake.teleop.simulated_arms import SimulatedArms
from hydrolek_drake.workcell.grasp import tool_in_world
from hydrolek_drake.workcell.loose_pipe import LoosePipe, clasped
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.table import Table
from hydrolek_drake.workcell.trajectory import joint_speeds

Array = NDArray[np.float64]


class ArmsEnd:
    """The controllers' end with the simple simulated arms: a link server whose set points the arms follow.

    Args:
        posture: Joints at first, in rad, shape (14,).
        port: TCP port, 0 for any free one.
        host: Address to listen at.
        pipe: A loose pipe, which goes with a hand whose jaw has closed around it.
        table: What it stands on.
    """

    def __init__(
        self,
        posture: Array,
        *,
        port: int | None = None,
        host: str = "127.0.0.1",
        pipe: Pipe | None = None,
        table: Table | None = None,
    ) -> None:
        self.server = SetpointServer(posture, port=port, host=host)
        self._period = teleop_entries("task")["period"]
        self._arms = SimulatedArms(posture, self._period)
        self._simulator = Simulator(self._arms)
        self._position = np.array(posture, dtype=float)
        self._driven: Array | None = None
        self._loose = None if pipe is None or table is None else LoosePipe(pipe)
        self._table = table
        self.pipe: Pipe | None = None if self._loose is None else pipe
        self._lower, self._upper = travel()

    def advance(self) -> Array:
        """Let the arms follow for one period; returns the measured joints in rad, shape (14,)."""
        context = self._simulator.get_mutable_context()
        order = self.server.order()
        desired = order.desired
        if order.deflection is None:
            self._driven = None
        else:  # deflection 100 %: the planner's speed
            begin = self._position if self._driven is None else self._driven
            step = order.deflection / 100.0 * joint_speeds()[0] * self._period
            self._driven = desired = np.clip(begin + step, self._lower, self._upper)
        self._arms.position_desired_input.FixValue(context, desired)
        self._arms.valves_open_input.FixValue(context, [float(order.valves_open)])
        self._simulator.AdvanceTo(context.get_time() + self._period)
        self._position = np.array(self._arms.position_measured_output.Eval(context))
        if self._loose is not None and self._table is not None:
            hands = [tool_in_world(self._position, side) for side in SIDES]
            gripped = [
                clasped(self._loose.now(hands), hand[1], self._position[7 * place + 6])
                for place, hand in enumerate(hands)
            ]
            self._loose = self._loose.step(hands, gripped, self._table, self._period)
            self.pipe = self._loose.now(hands)
        self.server.report(self._position)
        return self._position
