"""Pump and return line, shared by all joints of both arms."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, ContinuousState, DiscreteValues, LeafSystem

from hydrolek_drake.physics.probes import SUPPLY
from hydrolek_drake.physics.relief_valve import relieved_by_valve
from hydrolek_drake.physics.supply import PUMP, at_start, rate_of_change, supply_pressure
from hydrolek_drake.systems.recorded import Recorded
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _pressure(joints: np.ndarray, remembered: float, share: float) -> float:
    tank = joints[0].supply.tank_pressure
    return tank + min(max(share, 0.0), 1.0) * (supply_pressure(remembered, joints[0]) - tank)


@njit(cache=True)
def _rate(joints: np.ndarray, remembered: float, relief: float, flows: np.ndarray) -> tuple[float, float]:
    drawn = 0.0
    for i in range(2 * len(joints), 3 * len(joints)):
        drawn += flows[i]
    return rate_of_change(remembered, relief, drawn, joints[0])


@njit(cache=True)
def _filled(
    joints: np.ndarray, above: float, valve: float, before: float, flows: np.ndarray, h: float
) -> tuple[float, float, float]:
    """Pressure and valve after a step, and the rate at its beginning.

    The rate is carried on from the step before to the middle of this one (Adams and Bashforth), so that what the
    joints draw meanwhile counts to second order.
    """
    rate, slope = _rate(joints, above, valve, flows)
    middle = rate if np.isnan(before) else 1.5 * rate - 0.5 * before
    above, valve = relieved_by_valve(above, valve, middle, slope, h, joints[0])
    return above, valve, rate


@njit(cache=True)
def _at_start(joints: np.ndarray) -> tuple[float, float]:
    return at_start(joints[0])


class Supply(LeafSystem):
    """Supply pressure from the flow that all joints draw together.

    A constant pressure remembers that flow, low-passed, as a continuous state. A line with a relief valve settles in
    a tenth of a millisecond: it advances in the diagram's steps by the one-step method of the rollout,
    `relief_valve.relieved_by_valve`, from the flow that a step begins with, and hands on its mean over the running
    step.

    Ports:
        in `oil_flow` (3n): its last n entries are drawn from the supply [m^3/s].
        in `pressure_available` (1): share of the pump's pressure that is there, 1 when healthy, 0 when a hose
            has burst; 1 if unconnected.
        in `outside` (15 n): what laws add, or open; all joints feel it.
        out `supply_pressure` (1) [Pa].
    """

    def __init__(self, joints: np.ndarray, step: float, recorded: Recorded | None = None):
        """Build.

        Args:
            joints: their records; the supply's own parameters are those of the first joint.
            step: of the diagram [s].
            recorded: what was recorded, where it drives joints; a supply pressure takes the place of this one's.
        """
        super().__init__()
        self.set_name("supply")
        self._joints = joints
        self._step = step
        self._n = len(joints)
        driven = bool(joints["driven"]["supply_pressure"][0] > 0.0)
        self._recorded = recorded if driven else None
        self.flow = self.DeclareVectorInputPort("oil_flow", 3 * self._n)
        self.available = self.DeclareVectorInputPort("pressure_available", 1)
        self.outside = Outside(self, self._n)
        self._pump = bool(joints["supply"]["variant"][0] == PUMP)
        start, valve = _at_start(joints)
        if self._pump:
            self._ends = self.DeclareDiscreteState([start, valve, np.nan])
            self._mean = self.DeclareDiscreteState([start])
            self.DeclarePeriodicDiscreteUpdateEvent(step, 0.0, self._update)
        else:
            self.DeclareContinuousState(BasicVector([start]))
        self.pressure = self.DeclareVectorOutputPort(
            "supply_pressure",
            1,
            self._calc,
            prerequisites_of_calc={
                self.xd_ticket() if self._pump else self.xc_ticket(),
                self.available.ticket(),
                self.outside.port.ticket(),
            }
            | ({self.time_ticket()} if self._recorded else set()),
        )

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Low-pass of the flow drawn."""
        if not self._pump:
            flow = context.get_continuous_state_vector().GetAtIndex(0)
            rate, _ = _rate(self._joints, flow, 0.0, self.flow.Eval(context))
            derivatives.get_mutable_vector().SetAtIndex(0, rate)

    def _update(self, context: Context, values: DiscreteValues) -> None:
        """`values` begins as a copy of the state."""
        begins, valve, before = values.get_value(self._ends)
        ends, *rest = _filled(self._joints, begins, valve, before, self.flow.Eval(context), self._step)
        values.get_mutable_value(self._ends)[:] = ends, *rest
        values.get_mutable_value(self._mean)[0] = 0.5 * (begins + ends)

    def _calc(self, context: Context, output: BasicVector) -> None:
        if self._pump:
            remembered = float(context.get_discrete_state(self._mean).get_value()[0])
        else:
            remembered = context.get_continuous_state_vector().GetAtIndex(0)
        share = self.available.Eval(context)[0] if self.available.HasValue(context) else 1.0
        added = float(self.outside.eval(context)[:, SUPPLY].sum())
        if self._recorded:
            tank = float(self._joints["supply"]["tank_pressure"][0])
            own = tank + share * (float(self._recorded.at(context.get_time())[0, SUPPLY]) - tank)
        else:
            own = _pressure(self._joints, remembered, share)
        output.SetAtIndex(0, own + added)
