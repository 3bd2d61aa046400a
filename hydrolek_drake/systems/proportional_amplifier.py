"""Proportional amplifiers A and B of every joint, and the coils that they drive."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from hydrolek_drake.physics.amplifier import Currents, coil_currents, following
from hydrolek_drake.physics.law import any_gives
from hydrolek_drake.physics.probes import AMPLIFIER, COIL_TIME
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _follow(
    joints: np.ndarray,
    before: np.ndarray,
    voltage: np.ndarray,
    outside: np.ndarray,
    time: float,
    step: float,
    reached: np.ndarray,
    mean: np.ndarray,
) -> None:
    """Write the currents at the end of a step, coils A and then B, and what the spool feels of them on average."""
    n = len(joints)
    for i in range(n):
        now, felt = following(
            Currents(before[i], before[n + i]), voltage[i], time, step, outside[i, COIL_TIME], joints[i]
        )
        gain = 1.0 + outside[i, AMPLIFIER]
        reached[i], reached[n + i] = now
        mean[i], mean[n + i] = gain * felt.a, gain * felt.b


class ProportionalAmplifier(LeafSystem):
    """Voltage to coil currents, equation (4.4), which a coil's inductance may slow.

    Ports:
        in `voltage_delayed` (n) [V].
        in `outside` (15 n): what a law adds, or open.
        out `coil_current` (2n): coils A, then coils B [A], means over a step that begins with the voltage; of a servo
            valve the voltage itself [V].
    """

    def __init__(self, joints: np.ndarray, step: float):
        """Build for the joints' records, shape (n,), and the diagram's step [s]."""
        super().__init__()
        self.set_name("proportional_amplifier")
        n = len(joints)
        self._joints = joints
        self._step = step
        self.voltage = self.DeclareVectorInputPort("voltage_delayed", n)
        self.outside = Outside(self, n)
        resting = [coil_currents(0.0, 0.0, joint) for joint in joints]
        self._resting = np.array(resting).T.ravel()
        self._slow = bool(np.any(joints["amplifier"]["coil_time"] > 0.0)) or any_gives(joints, COIL_TIME)
        if self._slow:  # each update costs a Diagram as much as its work
            self._before = self.DeclareDiscreteState(self._resting)
            self.DeclarePeriodicDiscreteUpdateEvent(step, 0.0, self._update)
        self.current = self.DeclareVectorOutputPort("coil_current", 2 * n, self._calc)

    def _after_a_step(self, context: Context) -> tuple[np.ndarray, np.ndarray]:
        """Currents at its end, and their means."""
        before = context.get_discrete_state().get_value(self._before) if self._slow else self._resting
        reached, mean = np.empty_like(before), np.empty_like(before)
        _follow(
            self._joints,
            before,
            self.voltage.Eval(context),
            self.outside.eval(context),
            context.get_time(),
            self._step,
            reached,
            mean,
        )
        return reached, mean

    def _calc(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._after_a_step(context)[1])

    def _update(self, context: Context, values: DiscreteValues) -> None:
        values.set_value(self._before, self._after_a_step(context)[0])
