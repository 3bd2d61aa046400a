"""The four-way directional valve of every joint."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.physics.lines.hose import LONG_LINE
from hydrolek_drake.physics.probes import BACK_A, BACK_B, VALVE
from hydrolek_drake.physics.valve import chamber_flows, port_sources
from hydrolek_drake.physics.valves.openings import openings, widened
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _flows(
    joints: np.ndarray,
    x: np.ndarray,
    pressure: np.ndarray,
    p_supply: float,
    outside: np.ndarray,
    time: float,
    out: np.ndarray,
) -> None:
    n = len(joints)
    for i in range(n):
        joint = joints[i]
        opened = widened(openings(x[i], joint), outside[i, VALVE])
        if joint.hose.variant == LONG_LINE:
            a, b, out[2 * n + i] = port_sources(
                opened,
                p_supply,
                pressure[i],
                pressure[n + i],
                time,
                joint,
                outside[i, BACK_A],
                outside[i, BACK_B],
            )
            out[i] = a.flow - a.conductance * pressure[i]
            out[n + i] = b.flow - b.conductance * pressure[n + i]
            continue
        out[i], out[n + i], out[2 * n + i], _, _ = chamber_flows(
            opened,
            p_supply,
            pressure[i],
            pressure[n + i],
            time,
            joint,
            outside[i, BACK_A],
            outside[i, BACK_B],
        )


class FourWayValve(LeafSystem):
    """Spool position to oil flow, equations (4.7), (4.8) with overlap.

    Ports:
        in `spool_position` (n) [m].
        in `pressure` (2n): chambers A, then B [Pa]; ports where long lines lead on.
        in `supply_pressure` (1) [Pa].
        in `outside` (15 n): what a law adds, or open.
        out `oil_flow` (3n): into chambers A, into chambers B (leakage past the piston included), and drawn
            from the supply [m^3/s]; through ports A and B where long lines lead on.
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("four_way_valve")
        n = len(joints)
        self._joints = joints
        self.spool = self.DeclareVectorInputPort("spool_position", n)
        self.pressure = self.DeclareVectorInputPort("pressure", 2 * n)
        self.supply = self.DeclareVectorInputPort("supply_pressure", 1)
        self.outside = Outside(self, n)
        self.flow = self.DeclareVectorOutputPort("oil_flow", 3 * n, self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        _flows(
            self._joints,
            self.spool.Eval(context),
            self.pressure.Eval(context),
            float(self.supply.Eval(context)[0]),
            self.outside.eval(context),
            context.get_time(),
            output.get_mutable_value(),
        )
