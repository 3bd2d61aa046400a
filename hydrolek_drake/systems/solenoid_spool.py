"""Solenoids A and B of every joint and the spool between them."""

import numpy as np
from numba import njit
from pydrake.systems.framework import Context, DiscreteValues, LeafSystem

from hydrolek_drake.physics.driven import INPUTS
from hydrolek_drake.physics.law import any_gives
from hydrolek_drake.physics.probes import FLOW_FORCE, PROBES
from hydrolek_drake.physics.solenoid import advance
from hydrolek_drake.physics.valve import flow_forces
from hydrolek_drake.systems.recorded import Recorded
from hydrolek_drake.systems.short_law import Outside
from hydrolek_drake.systems.transport_delay import whole_steps_and_rest


@njit(cache=True)
def _advance(
    joints: np.ndarray,
    state: np.ndarray,
    current: np.ndarray,
    rest: np.ndarray,
    step: float,
    substeps: int,
    mean: np.ndarray,
    pressure: np.ndarray,
    p_supply: float,
    outside: np.ndarray,
) -> None:
    """Advance positions and velocities in place; `mean` becomes the mean position over the step.

    For its share `rest` of the step the currents from before go on, the second half of `state`; then come those of
    `current`.
    """
    n = len(joints)
    before = state[2 * n :]
    for i in range(n):
        x, v = state[i], state[n + i]
        area = 0.0
        closing_a, closing_b = flow_forces(
            p_supply, pressure[i], pressure[n + i], outside[i, FLOW_FORCE], joints[i]
        )
        left = 1.0 - rest[i]
        if rest[i] > 0.0:
            a, b = before[i], before[n + i]
            if np.isnan(a):  # nothing ran before the first step
                a, b = current[i], current[n + i]
            following, v = advance(x, v, a, b, rest[i] * step, substeps, joints[i], closing_a, closing_b)
            area += 0.5 * rest[i] * (x + following)
            x = following
        following, v = advance(
            x, v, current[i], current[n + i], left * step, substeps, joints[i], closing_a, closing_b
        )
        mean[i] = area + 0.5 * left * (x + following)
        state[i], state[n + i] = following, v
        before[i], before[n + i] = current[i], current[n + i]


class SolenoidSpool(LeafSystem):
    """Coil currents to spool position, equations (4.5), (4.6).

    The spool depends on the currents, and for its flow forces on the pressures that a step begins with. It is stiff
    where it sticks, so it advances in steps of its own with the same one-step method as the rollout. Its output is the
    mean position over the running step. Where the transport delay is no multiple of the step, new currents begin
    within it, as they do in the rollout.

    Ports:
        in `coil_current` (2n) [A].
        in `pressure` (2n): chambers A, then B [Pa]; read only where `feels_oil`, as the next two are.
        in `supply_pressure` (1) [Pa].
        in `outside` (15 n): what a law adds, or open.
        out `spool_position` (n): positive opens P to A [m].
    """

    def __init__(self, joints: np.ndarray, step: float, substeps: int, recorded: Recorded | None = None):
        """Build.

        Args:
            joints: their records.
            step: of the diagram [s].
            substeps: steps of the spool within it.
            recorded: what was recorded, where it drives joints; a spool's position takes the place of this one's.
        """
        super().__init__()
        self.set_name("solenoid_spool")
        n = len(joints)
        self._joints = joints
        self._step = step
        self._substeps = substeps
        _, self._rest = whole_steps_and_rest(joints, step)
        self.current = self.DeclareVectorInputPort("coil_current", 2 * n)
        self.pressure = self.DeclareVectorInputPort("pressure", 2 * n)
        self.supply = self.DeclareVectorInputPort("supply_pressure", 1)
        self.outside = Outside(self, n)
        self.feels_oil = bool(np.any(joints["valve"]["flow_force"] > 0.0)) or any_gives(joints, FLOW_FORCE)
        self._unfelt = np.zeros(2 * n), 0.0, np.zeros((n, len(PROBES)))
        # one group of positions, velocities and currents: each that an update asks for costs as much as its work
        self._driven = joints["driven"]["spool_position"] > 0.0
        self._recorded = recorded if self._driven.any() else None
        self._state = self.DeclareDiscreteState(np.concatenate([np.zeros(2 * n), np.full(2 * n, np.nan)]))
        self._mean = self.DeclareDiscreteState(np.zeros(n))
        self.DeclarePeriodicDiscreteUpdateEvent(step, 0.0, self._update)
        self.position = self.DeclareStateOutputPort("spool_position", self._mean)

    def _update(self, context: Context, values: DiscreteValues) -> None:
        """`values` begins as a copy of the state."""
        _advance(
            self._joints,
            values.get_mutable_value(self._state),
            self.current.Eval(context),
            self._rest,
            self._step,
            self._substeps,
            values.get_mutable_value(self._mean),
            *self._oil(context),
        )
        if self._recorded:
            middle = self._recorded.at(context.get_time() + 0.5 * self._step)[:, INPUTS["spool_position"][0]]
            values.get_mutable_value(self._mean)[self._driven] = middle[self._driven]

    def _oil(self, context: Context) -> tuple[np.ndarray, float, np.ndarray]:
        """Pressures of the chambers and of the supply, and what laws add; each that is asked for costs time."""
        if not self.feels_oil:
            return self._unfelt
        supply = float(self.supply.Eval(context)[0])
        return self.pressure.Eval(context), supply, self.outside.eval(context)
