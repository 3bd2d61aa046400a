"""Play between each actuator's side and its link (effect linkage.backlash)."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, ContinuousState, LeafSystem

from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.linkage import play_torque


@njit(cache=True)
def _contact(
    joints: np.ndarray, lead: np.ndarray, motion: np.ndarray, moment: np.ndarray, out: np.ndarray
) -> None:
    n = len(joints)
    for i in range(n):
        out[i] = moment[i]
        if hooks.linkage_gap(joints[i]) > 0.0:
            out[i] = play_torque(lead[i] - motion[i], lead[n + i] - motion[n + i], joints[i])


@njit(cache=True)
def _rates(
    joints: np.ndarray, lead: np.ndarray, motion: np.ndarray, moment: np.ndarray, out: np.ndarray
) -> None:
    n = len(joints)
    for i in range(n):
        out[i], out[n + i] = lead[n + i], 0.0
        if hooks.linkage_gap(joints[i]) > 0.0:
            through = play_torque(lead[i] - motion[i], lead[n + i] - motion[n + i], joints[i])
            out[n + i] = (moment[i] - through) / joints[i].linkage.play_inertia


@njit(cache=True)
def _side(joints: np.ndarray, lead: np.ndarray, motion: np.ndarray, out: np.ndarray) -> None:
    n = len(joints)
    for i in range(n):
        playing = hooks.linkage_gap(joints[i]) > 0.0
        out[i] = lead[i] if playing else motion[i]
        out[n + i] = lead[n + i] if playing else motion[n + i]


class Play(LeafSystem):
    """The actuator's side of each joint as a small inertia that meets the link at the ends of its play.

    A joint without play passes through.

    Ports:
        in `joint_motion` (2n): of the links.
        in `moment` (n): of the actuators [N m].
        out `side_motion` (2n): of the actuators' side.
        out `moment_transmitted` (n): on the links [N m].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("play")
        n = len(joints)
        self._joints = joints
        self._n = n
        self.motion = self.DeclareVectorInputPort("joint_motion", 2 * n)
        self.moment = self.DeclareVectorInputPort("moment", n)
        self._state = self.DeclareContinuousState(BasicVector(2 * n))
        self.side = self.DeclareVectorOutputPort(
            "side_motion",
            2 * n,
            self._calc_side,
            prerequisites_of_calc={self.xc_ticket(), self.motion.ticket()},
        )
        self.transmitted = self.DeclareVectorOutputPort("moment_transmitted", n, self._calc_transmitted)

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Motion of the actuators' side."""
        rates = np.empty(2 * self._n)
        lead = context.get_continuous_state_vector().CopyToVector()
        _rates(self._joints, lead, self.motion.Eval(context), self.moment.Eval(context), rates)
        derivatives.SetFromVector(rates)

    def _calc_side(self, context: Context, output: BasicVector) -> None:
        side = np.empty(2 * self._n)
        _side(
            self._joints,
            context.get_continuous_state_vector().CopyToVector(),
            self.motion.Eval(context),
            side,
        )
        output.SetFromVector(side)

    def _calc_transmitted(self, context: Context, output: BasicVector) -> None:
        moment = np.empty(self._n)
        lead = context.get_continuous_state_vector().CopyToVector()
        _contact(self._joints, lead, self.motion.Eval(context), self.moment.Eval(context), moment)
        output.SetFromVector(moment)
