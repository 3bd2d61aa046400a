"""What acts on every joint besides gravity and the cylinders' mount forces."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.physics.load import SLIDING, gravity_load, passive_load
from hydrolek_drake.physics.probes import LOAD
from hydrolek_drake.systems.linkage import Chain
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _torques(
    joints: np.ndarray,
    state: np.ndarray,
    q: np.ndarray,
    w: np.ndarray,
    moment: np.ndarray,
    acts: np.ndarray,
    outside: np.ndarray,
    time: float,
    place: np.ndarray,
    out: np.ndarray,
) -> None:
    """`q` and `w` say where each joint stands in `state`, `place` where in `out`."""
    for i in range(len(joints)):
        position, velocity = state[q[i]], state[w[i]]
        passive, _ = passive_load(position, velocity, joints[i])
        torque = moment[i] * acts[i] - passive + outside[i, LOAD]
        if joints[i].load.variant == SLIDING:
            torque -= gravity_load(position, time, joints[i])
        out[place[i]] = torque


class Load(LeafSystem):
    """Damping, friction, end stops (thesis 4.1, 4.9) and the moments of vane and motor.

    Gravity and inertia of turning links are the MultibodyPlant's; the constant force on a sliding mass is
    added here.

    Ports:
        in `plant_state` (all positions and velocities of the plant).
        in `moment` (n): of the actuators [N m]; may stay open if all of them act at their mounts.
        in `outside` (15 n): what a law adds, or open.
        out `joint_torque` (velocities of the plant): generalized forces [N m or N].
    """

    def __init__(self, joints: np.ndarray, chain: Chain, velocities: int, by_moment: np.ndarray):
        """Build for the joints' records.

        Args:
            joints: shape (n,).
            chain: says where each joint stands in the plant's state.
            velocities: number of the plant's velocities (and positions).
            by_moment: True where the actuator acts by its moment, not by forces at its mounts, shape (n,).
        """
        super().__init__()
        self.set_name("load")
        n = len(joints)
        self._joints = joints
        self._chain = chain
        self._place = chain.velocity_index - velocities
        self._acts = by_moment.astype(float)
        self._moments = bool(by_moment.any())
        self._none = np.zeros(n)
        self.plant_state = self.DeclareVectorInputPort("plant_state", 2 * velocities)
        self.moment = self.DeclareVectorInputPort("moment", n)
        self.outside = Outside(self, n)
        self.torque = self.DeclareVectorOutputPort("joint_torque", velocities, self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        torque = output.get_mutable_value()
        torque[:] = 0.0
        _torques(
            self._joints,
            self.plant_state.Eval(context),
            self._chain.position_index,
            self._chain.velocity_index,
            self.moment.Eval(context) if self._moments else self._none,
            self._acts,
            self.outside.eval(context),
            context.get_time(),
            self._place,
            torque,
        )
