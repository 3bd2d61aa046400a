"""Ramps of the amplifiers' cards, which let a voltage change no faster than so many volts a second."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from hydrolek_drake.physics.command import ramped
from hydrolek_drake.physics.probes import RAMP
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _ramped(
    joints: np.ndarray,
    behind: np.ndarray,
    voltage: np.ndarray,
    outside: np.ndarray,
    step: float,
    reached: np.ndarray,
    mean: np.ndarray,
) -> None:
    """Write the voltages that are reached at the end of a step, and their means over it."""
    for i in range(len(joints)):
        reached[i], mean[i] = ramped(behind[i], voltage[i], step, outside[i, RAMP], joints[i])


class CommandRamp(LeafSystem):
    """A voltage held over a step to the one behind the ramp (`physics.command.ramped`).

    Where the transport delay is no multiple of the step a voltage arrives within one; a step here is then the one
    from there on, as the spool takes it.

    Ports:
        in `voltage` (n): positive towards chamber A [V].
        in `outside` (15 n): what a law adds, or open.
        out `voltage_ramped` (n): its mean over the step [V].
    """

    def __init__(self, joints: np.ndarray, step: float):
        """Build for the joints' records, shape (n,), and the diagram's step [s]."""
        super().__init__()
        self.set_name("command_ramp")
        n = len(joints)
        self._joints = joints
        self._step = step
        self.voltage = self.DeclareVectorInputPort("voltage", n)
        self.outside = Outside(self, n)
        self._behind = self.DeclareDiscreteState(np.zeros(n))
        self.DeclarePeriodicDiscreteUpdateEvent(step, 0.0, self._update)
        self.ramped = self.DeclareVectorOutputPort("voltage_ramped", n, self._calc)

    def _after_a_step(self, context: Context) -> tuple[np.ndarray, np.ndarray]:
        """Voltages at its end, and their means."""
        behind = context.get_discrete_state().get_value(self._behind)
        reached, mean = np.empty_like(behind), np.empty_like(behind)
        _ramped(
            self._joints,
            behind,
            self.voltage.Eval(context),
            self.outside.eval(context),
            self._step,
            reached,
            mean,
        )
        return reached, mean

    def _calc(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._after_a_step(context)[1])

    def _update(self, context: Context, values: DiscreteValues) -> None:
        values.set_value(self._behind, self._after_a_step(context)[0])
