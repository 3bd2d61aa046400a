"""An electric motor with a force constant in place of the hydraulic chain."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.physics.cylinder import motor_force


@njit(cache=True)
def _forces(joints: np.ndarray, voltage: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(joints)):
        out[i] = motor_force(voltage[i], joints[i])


class ElectricMotor(LeafSystem):
    """Voltage to force.

    Ports:
        in `voltage_delayed` (n) [V].
        out `rod_force` (n) [N].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("electric_motor")
        self._joints = joints
        self.voltage = self.DeclareVectorInputPort("voltage_delayed", len(joints))
        self.force = self.DeclareVectorOutputPort("rod_force", len(joints), self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        force = np.empty(len(self._joints))
        _forces(self._joints, self.voltage.Eval(context), force)
        output.SetFromVector(force)
