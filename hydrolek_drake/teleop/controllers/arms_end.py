"""The simple simulated arms as a machine behind the link."""

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import Simulator

from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.teleop.access import new_token
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.simulated_arms import SimulatedArms
from hydrolek_drake.teleop.hand import travel
from hydrolek_drake.teleop.link.authority import LinkOrder
from hydrolek_drake.teleop.link.server import SetpointServer
from hydrolek_drake.workcell.grasp import tool_in_world
from hydrolek_drake.workcell.loose_pipe import LoosePipe, clasped
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.table import Table
from hydrolek_drake.workcell.trajectory import joint_speeds

Array = NDArray[np.float64]


class SimpleArms:
    """`SimulatedArms` behind the link (see `adapter.Arms`), with the loose pipe that they may carry.

    Args:
        posture: Joints at first, in rad, shape (14,).
        pipe: A loose pipe, which goes with a hand whose jaw has closed around it.
        table: What it stands on.

    Attributes:
        period: Seconds between two samples.
        pipe: Where the loose pipe is, or None.
    """

    def __init__(self, posture: Array, *, pipe: Pipe | None = None, table: Table | None = None) -> None:
        self.period: float = teleop_entries("task")["period"]
        self._arms = SimulatedArms(posture, self.period)
        self._simulator = Simulator(self._arms)
        self._position = np.array(posture, dtype=float)
        self._driven: Array | None = None
        self._loose = None if pipe is None or table is None else LoosePipe(pipe)
        self._table = table
        self.pipe: Pipe | None = None if self._loose is None else pipe
        self._lower, self._upper = travel()

    def advance(self, order: LinkOrder) -> None:
        """Follow for one period."""
        context = self._simulator.get_mutable_context()
        desired = order.desired
        if order.deflection is None:
            self._driven = None
        else:  # deflection 100 %: the planner's speed
            begin = self._position if self._driven is None else self._driven
            step = order.deflection / 100.0 * joint_speeds()[0] * self.period
            self._driven = desired = np.clip(begin + step, self._lower, self._upper)
        self._arms.position_desired_input.FixValue(context, desired)
        self._arms.valves_open_input.FixValue(context, [float(order.valves_open)])
        self._simulator.AdvanceTo(context.get_time() + self.period)
        self._position = np.array(self._arms.position_measured_output.Eval(context))
        if self._loose is not None and self._table is not None:
            hands = [tool_in_world(self._position, side) for side in SIDES]
            gripped = [
                clasped(self._loose.now(hands), hand[1], self._position[7 * place + 6])
                for place, hand in enumerate(hands)
            ]
            self._loose = self._loose.step(hands, gripped, self._table, self.period)
            self.pipe = self._loose.now(hands)

    def measured(self) -> Array:
        """Joints in rad, shape (14,)."""
        return self._position

    def signals(self) -> None:
        """They have none."""
        return None

    def close(self) -> None:
        """Nothing is held."""


class ArmsEnd:
    """The simple arms with a link of their own on the loopback, stepped by who owns them.

    Args:
        posture: Joints at first, in rad, shape (14,).
        pipe: As of `SimpleArms`.
        table: Likewise.

    Attributes:
        server: The link.
        token: What it asks for.
    """

    def __init__(self, posture: Array, *, pipe: Pipe | None = None, table: Table | None = None) -> None:
        self.token = new_token()
        self.server = SetpointServer(posture, port=0, token=self.token)
        self._arms = SimpleArms(posture, pipe=pipe, table=table)

    @property
    def pipe(self) -> Pipe | None:
        """Where the loose pipe is, or None."""
        return self._arms.pipe

    def advance(self) -> Array:
        """Let the arms follow for one period; returns the measured joints in rad, shape (14,)."""
        self._arms.advance(self.server.order())
        self.server.report(self._arms.measured())
        return self._arms.measured()
