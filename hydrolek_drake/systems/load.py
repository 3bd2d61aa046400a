"""What acts on every joint besides gravity and the cylinders' mount forces."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.physics.load import SLIDING, gravity_load, passive_load


@njit(cache=True)
def _torques(
    joints: np.ndarray, motion: np.ndarray, moment: np.ndarray, acts: np.ndarray, time: float, out: np.ndarray
) -> None:
    n = len(joints)
    for i in range(n):
        passive, _ = passive_load(motion[i], motion[n + i], joints[i])
        out[i] = moment[i] * acts[i] - passive
        if joints[i].load.variant == SLIDING:
            out[i] -= gravity_load(motion[i], time, joints[i])


class Load(LeafSystem):
    """Damping, friction, end stops (thesis 4.1, 4.9) and the moments of vane and motor.

    Gravity and inertia of turning links are the MultibodyPlant's; the constant force on a sliding mass is
    added here.

    Ports:
        in `joint_motion` (2n).
        in `moment` (n): of the actuators [N m].
        out `joint_torque` (velocities of the plant): generalized forces [N m or N].
    """

    def __init__(
        self, joints: np.ndarray, velocity_index: np.ndarray, velocities: int, by_moment: np.ndarray
    ):
        """Build for the joints' records.

        Args:
            joints: shape (n,).
            velocity_index: each joint's place among the plant's velocities, shape (n,).
            velocities: number of the plant's velocities.
            by_moment: True where the actuator acts by its moment, not by forces at its mounts, shape (n,).
        """
        super().__init__()
        self.set_name("load")
        n = len(joints)
        self._joints = joints
        self._index = velocity_index
        self._acts = by_moment.astype(float)
        self.motion = self.DeclareVectorInputPort("joint_motion", 2 * n)
        self.moment = self.DeclareVectorInputPort("moment", n)
        self.torque = self.DeclareVectorOutputPort("joint_torque", velocities, self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        torque = np.empty(len(self._joints))
        _torques(
            self._joints,
            self.motion.Eval(context),
            self.moment.Eval(context),
            self._acts,
            context.get_time(),
            torque,
        )
        full = np.zeros(output.size())
        full[self._index] = torque
        output.SetFromVector(full)
