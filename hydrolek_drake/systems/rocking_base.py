"""A base that rocks under each joint's actuator (effect base.compliance)."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, ContinuousState, LeafSystem

from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.base import base_acceleration


@njit(cache=True)
def _rates(joints: np.ndarray, tilt: np.ndarray, moment: np.ndarray, out: np.ndarray) -> None:
    n = len(joints)
    for i in range(n):
        out[i], out[n + i] = tilt[n + i], 0.0
        if hooks.base_stiffness(joints[i]) > 0.0:
            out[n + i], _ = base_acceleration(tilt[i], tilt[n + i], moment[i], joints[i])


class RockingBase(LeafSystem):
    """The base's tilt under the reaction of each actuator; cylinder and sensor see the angle less the tilt.

    Ports:
        in `moment` (n): of the actuators [N m].
        in `motion` (2n): as without the base.
        out `motion_relative` (2n): less the tilt.
        out `tilt` (2n): angles, then rates.
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("rocking_base")
        n = len(joints)
        self._joints = joints
        self.moment = self.DeclareVectorInputPort("moment", n)
        self.motion = self.DeclareVectorInputPort("motion", 2 * n)
        self._state = self.DeclareContinuousState(BasicVector(2 * n))
        self.tilt = self.DeclareStateOutputPort("tilt", self._state)
        self.relative = self.DeclareVectorOutputPort(
            "motion_relative",
            2 * n,
            self._calc,
            prerequisites_of_calc={self.xc_ticket(), self.motion.ticket()},
        )

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Motion of the base."""
        rates = np.empty(2 * len(self._joints))
        _rates(
            self._joints,
            context.get_continuous_state_vector().CopyToVector(),
            self.moment.Eval(context),
            rates,
        )
        derivatives.SetFromVector(rates)

    def _calc(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self.motion.Eval(context) - context.get_continuous_state_vector().CopyToVector())
