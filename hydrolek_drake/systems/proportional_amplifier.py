"""Proportional amplifiers A and B of every joint."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.physics.amplifier import coil_currents
from hydrolek_drake.physics.probes import AMPLIFIER
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _currents(
    joints: np.ndarray, voltage: np.ndarray, outside: np.ndarray, time: float, out: np.ndarray
) -> None:
    n = len(joints)
    for i in range(n):
        gain = 1.0 + outside[i, AMPLIFIER]
        current_a, current_b = coil_currents(voltage[i], time, joints[i])
        out[i], out[n + i] = gain * current_a, gain * current_b


class ProportionalAmplifier(LeafSystem):
    """Voltage to coil currents, equation (4.4).

    Ports:
        in `voltage_delayed` (n) [V].
        in `outside` (12 n): what a law adds, or open.
        out `coil_current` (2n): coils A, then coils B [A]; of a servo valve the voltage itself [V].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("proportional_amplifier")
        self._joints = joints
        self.voltage = self.DeclareVectorInputPort("voltage_delayed", len(joints))
        self.outside = Outside(self, len(joints))
        self.current = self.DeclareVectorOutputPort("coil_current", 2 * len(joints), self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        _currents(
            self._joints,
            self.voltage.Eval(context),
            self.outside.eval(context),
            context.get_time(),
            output.get_mutable_value(),
        )
