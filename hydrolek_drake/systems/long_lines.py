"""Long lines between the valves of some joints and their chambers."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, ContinuousState, LeafSystem

from hydrolek_drake.physics.lines.hose import LONG_LINE
from hydrolek_drake.physics.lines.long_line import (
    LINES_SIZE,
    Line,
    Source,
    line_rates,
    lines_in,
    pipes,
    put_lines,
    resting_lines,
)
from hydrolek_drake.physics.valve import beside_lines

_LINE = len(Line._fields)


@njit(cache=True)
def _rates(
    joints: np.ndarray,
    lined: np.ndarray,
    state: np.ndarray,
    port_flow: np.ndarray,
    pressure: np.ndarray,
    out: np.ndarray,
) -> None:
    n = len(joints)
    for k in range(len(lined)):
        i, begin = lined[k], k * LINES_SIZE
        lines = lines_in(state[begin : begin + LINES_SIZE])
        of_a, of_b = pipes(joints[i])
        # what enters is known as a flow here
        a = line_rates(lines.a, Source(port_flow[i], 0.0), pressure[i], of_a)
        b = line_rates(lines.b, Source(port_flow[n + i], 0.0), pressure[n + i], of_b)
        for at, line in ((begin, a), (begin + _LINE, b)):
            for number in range(_LINE):
                rate = line[number]
                if number % 2 == 0 and state[at + number] <= 0.0:  # pressures do not fall below zero
                    rate = max(rate, 0.0)
                out[at + number] = rate


@njit(cache=True)
def _flows(
    joints: np.ndarray,
    lined: np.ndarray,
    state: np.ndarray,
    port_flow: np.ndarray,
    pressure: np.ndarray,
    out: np.ndarray,
) -> None:
    n = len(joints)
    out[:] = port_flow
    for k in range(len(lined)):
        i, begin = lined[k], k * LINES_SIZE
        a, b = state[begin + _LINE - 1], state[begin + LINES_SIZE - 1]
        out[i], out[n + i], _, _ = beside_lines(a, b, pressure[i], pressure[n + i], joints[i])


@njit(cache=True)
def _put_resting(state: np.ndarray, p_a: float, p_b: float) -> None:
    put_lines(state, resting_lines(p_a, p_b))


class LongLines(LeafSystem):
    """Flows at the valves' ports to flows into the chambers, and the chambers' pressures to those at the ports.

    Joints without long lines pass through.

    Ports:
        in `port_flow` (3n): through ports A, then B, and drawn from the supply [m^3/s].
        in `pressure` (2n): chambers A, then B [Pa].
        out `port_pressure` (2n): ports A, then B [Pa].
        out `oil_flow` (3n): into chambers A, into chambers B (leakage past the piston included), and drawn from the
            supply [m^3/s].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("long_lines")
        n = len(joints)
        self._joints = joints
        self._lined = np.flatnonzero(joints["hose"]["variant"] == LONG_LINE)
        self._ports = np.concatenate([[i, n + i] for i in self._lined])
        firsts = np.arange(len(self._lined)) * LINES_SIZE
        self._at_valve = np.stack([firsts, firsts + _LINE], axis=1).ravel()
        self.flow_in = self.DeclareVectorInputPort("port_flow", 3 * n)
        self.pressure_in = self.DeclareVectorInputPort("pressure", 2 * n)
        self.DeclareContinuousState(len(self._lined) * LINES_SIZE)
        seen = {self.xc_ticket(), self.pressure_in.ticket()}
        self.pressure = self.DeclareVectorOutputPort(
            "port_pressure", 2 * n, self._calc_pressure, prerequisites_of_calc=seen
        )
        self.flow = self.DeclareVectorOutputPort(
            "oil_flow", 3 * n, self._calc_flow, prerequisites_of_calc=seen | {self.flow_in.ticket()}
        )

    def rest(self, context: Context, pressures: np.ndarray) -> None:
        """Let nothing flow, at the chambers' pressures [Pa]. # (n, 2)."""
        state = np.empty(len(self._lined) * LINES_SIZE)
        for k, i in enumerate(self._lined):
            _put_resting(state[k * LINES_SIZE : (k + 1) * LINES_SIZE], *pressures[i])
        context.SetContinuousState(state)

    def _calc_pressure(self, context: Context, output: BasicVector) -> None:
        pressure = self.pressure_in.Eval(context).copy()
        pressure[self._ports] = context.get_continuous_state_vector().CopyToVector()[self._at_valve]
        output.SetFromVector(pressure)

    def _calc_flow(self, context: Context, output: BasicVector) -> None:
        _flows(*self._all(context), output.get_mutable_value())

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Rates of pressures and flows along the lines."""
        rates = np.empty(len(self._lined) * LINES_SIZE)
        _rates(*self._all(context), rates)
        derivatives.SetFromVector(rates)

    def _all(self, context: Context) -> tuple[np.ndarray, ...]:
        state = context.get_continuous_state_vector().CopyToVector()
        return self._joints, self._lined, state, self.flow_in.Eval(context), self.pressure_in.Eval(context)
