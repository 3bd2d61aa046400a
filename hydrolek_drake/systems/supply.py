"""Pump and return line, shared by all joints of both arms."""

import numpy as np
from pydrake.systems.framework import BasicVector, Context, ContinuousState, LeafSystem

from hydrolek_drake.physics.supply import flow_rate_of_change, supply_pressure


class Supply(LeafSystem):
    """Supply pressure from the flow that all joints draw together.

    Ports:
        in `oil_flow` (3n): its last n entries are drawn from the supply [m^3/s].
        in `pressure_available` (1): share of the pump's pressure that is there, 1 when healthy, 0 when a hose
            has burst; 1 if unconnected.
        out `supply_pressure` (1) [Pa].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records; the supply's own parameters are those of the first joint."""
        super().__init__()
        self.set_name("supply")
        self._joint = joints[0]
        self._n = len(joints)
        self.flow = self.DeclareVectorInputPort("oil_flow", 3 * self._n)
        self.available = self.DeclareVectorInputPort("pressure_available", 1)
        self._state = self.DeclareContinuousState(BasicVector([0.0]))
        self.pressure = self.DeclareVectorOutputPort(
            "supply_pressure",
            1,
            self._calc,
            prerequisites_of_calc={self.xc_ticket(), self.available.ticket()},
        )

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Low-pass of the flow drawn."""
        flow = context.get_continuous_state_vector().GetAtIndex(0)
        drawn = float(self.flow.Eval(context)[2 * self._n :].sum())
        derivatives.get_mutable_vector().SetAtIndex(0, flow_rate_of_change(flow, drawn, self._joint))

    def _calc(self, context: Context, output: BasicVector) -> None:
        flow = context.get_continuous_state_vector().GetAtIndex(0)
        share = float(self.available.Eval(context)[0]) if self.available.HasValue(context) else 1.0
        full = supply_pressure(flow, self._joint)
        tank = float(self._joint["supply"]["tank_pressure"])
        output.SetAtIndex(0, tank + np.clip(share, 0.0, 1.0) * (full - tank))
