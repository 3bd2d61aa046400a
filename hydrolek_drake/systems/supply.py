"""Pump and return line, shared by all joints of both arms."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, ContinuousState, LeafSystem

from hydrolek_drake.physics.probes import SUPPLY
from hydrolek_drake.physics.supply import flow_rate_of_change, supply_pressure
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _pressure(joints: np.ndarray, flow: float, share: float) -> float:
    tank = joints[0].supply.tank_pressure
    return tank + min(max(share, 0.0), 1.0) * (supply_pressure(flow, joints[0]) - tank)


@njit(cache=True)
def _rate(joints: np.ndarray, flow: float, flows: np.ndarray) -> float:
    drawn = 0.0
    for i in range(2 * len(joints), 3 * len(joints)):
        drawn += flows[i]
    return flow_rate_of_change(flow, drawn, joints[0])


class Supply(LeafSystem):
    """Supply pressure from the flow that all joints draw together.

    Ports:
        in `oil_flow` (3n): its last n entries are drawn from the supply [m^3/s].
        in `pressure_available` (1): share of the pump's pressure that is there, 1 when healthy, 0 when a hose
            has burst; 1 if unconnected.
        in `outside` (15 n): what laws add, or open; all joints feel it.
        out `supply_pressure` (1) [Pa].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records; the supply's own parameters are those of the first joint."""
        super().__init__()
        self.set_name("supply")
        self._joints = joints
        self._n = len(joints)
        self.flow = self.DeclareVectorInputPort("oil_flow", 3 * self._n)
        self.available = self.DeclareVectorInputPort("pressure_available", 1)
        self.outside = Outside(self, self._n)
        self._state = self.DeclareContinuousState(BasicVector([0.0]))
        self.pressure = self.DeclareVectorOutputPort(
            "supply_pressure",
            1,
            self._calc,
            prerequisites_of_calc={
                self.xc_ticket(),
                self.available.ticket(),
                self.outside.port.ticket(),
            },
        )

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Low-pass of the flow drawn."""
        flow = context.get_continuous_state_vector().GetAtIndex(0)
        rate = _rate(self._joints, flow, self.flow.Eval(context))
        derivatives.get_mutable_vector().SetAtIndex(0, rate)

    def _calc(self, context: Context, output: BasicVector) -> None:
        flow = context.get_continuous_state_vector().GetAtIndex(0)
        share = self.available.Eval(context)[0] if self.available.HasValue(context) else 1.0
        added = float(self.outside.eval(context)[:, SUPPLY].sum())
        output.SetAtIndex(0, _pressure(self._joints, flow, share) + added)
