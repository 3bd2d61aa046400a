"""Solenoids A and B of every joint and the spool between them."""

import numpy as np
from numba import njit
from pydrake.systems.framework import Context, DiscreteValues, LeafSystem

from hydrolek_drake.physics.solenoid import advance


@njit(cache=True)
def _advance(
    joints: np.ndarray, state: np.ndarray, current: np.ndarray, step: float, substeps: int, mean: np.ndarray
) -> None:
    """Advance positions and velocities in place; `mean` becomes the mean position over the step."""
    n = len(joints)
    for i in range(n):
        x, v = advance(state[i], state[n + i], current[i], current[n + i], step, substeps, joints[i])
        mean[i] = 0.5 * (state[i] + x)
        state[i], state[n + i] = x, v


class SolenoidSpool(LeafSystem):
    """Coil currents to spool position, equations (4.5), (4.6).

    The spool depends on the currents alone and is stiff where it sticks, so it advances in steps of its own
    with the same one-step method as the rollout. Its output is the mean position over the running step.

    Ports:
        in `coil_current` (2n) [A].
        out `spool_position` (n): positive opens P to A [m].
    """

    def __init__(self, joints: np.ndarray, step: float, substeps: int):
        """Build for the joints' records, the diagram's step [s] and the spool's steps within it."""
        super().__init__()
        self.set_name("solenoid_spool")
        n = len(joints)
        self._joints = joints
        self._step = step
        self._substeps = substeps
        self.current = self.DeclareVectorInputPort("coil_current", 2 * n)
        self._state = self.DeclareDiscreteState(np.zeros(2 * n))
        self._mean = self.DeclareDiscreteState(np.zeros(n))
        self.DeclarePeriodicDiscreteUpdateEvent(step, 0.0, self._update)
        self.position = self.DeclareStateOutputPort("spool_position", self._mean)

    def _update(self, context: Context, values: DiscreteValues) -> None:
        state = values.get_mutable_value(self._state)
        state[:] = context.get_discrete_state(self._state).get_value()
        mean = values.get_mutable_value(self._mean)
        _advance(self._joints, state, self.current.Eval(context), self._step, self._substeps, mean)
