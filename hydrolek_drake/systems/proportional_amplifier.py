"""Proportional amplifiers A and B of every joint."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.physics.amplifier import coil_currents


@njit(cache=True)
def _currents(joints: np.ndarray, voltage: np.ndarray, time: float, out: np.ndarray) -> None:
    n = len(joints)
    for i in range(n):
        out[i], out[n + i] = coil_currents(voltage[i], time, joints[i])


class ProportionalAmplifier(LeafSystem):
    """Voltage to coil currents, equation (4.4).

    Ports:
        in `voltage_delayed` (n) [V].
        out `coil_current` (2n): coils A, then coils B [A]; of a servo valve the voltage itself [V].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("proportional_amplifier")
        self._joints = joints
        self.voltage = self.DeclareVectorInputPort("voltage_delayed", len(joints))
        self.current = self.DeclareVectorOutputPort("coil_current", 2 * len(joints), self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        _currents(self._joints, self.voltage.Eval(context), context.get_time(), output.get_mutable_value())
