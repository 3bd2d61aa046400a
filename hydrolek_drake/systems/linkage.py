"""The linkages of every joint: stroke and lever, and the cylinders' forces at their mounting points."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from pydrake.common.value import AbstractValue, Value
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.physics.linkage import stroke_and_lever


@dataclass(frozen=True)
class Mount:
    """Where a cylinder is fixed, for its force.

    Attributes:
        joint: position of its joint in the rig's order.
        parent: index of the parent body, or None if that body never moves.
        child: index of the child body.
        p_parent: mount in the parent body's frame [m], shape (3,).
        p_child: mount in the child body's frame [m], shape (3,).
    """

    joint: int
    parent: int | None
    child: int
    p_parent: np.ndarray
    p_child: np.ndarray


@dataclass(frozen=True)
class Chain:
    """The moving bodies as a tree, in the rig's order of joints; enough to turn forces into the world frame.

    Attributes:
        position_index: of each joint in the plant's positions, shape (n,).
        velocity_index: of each joint in the plant's state vector, shape (n,).
        parent_joint: joint whose body carries this one, -1 for the world, shape (n,).
        frame_rotation: joint frame in the parent's frame at zero, shape (n, 3, 3).
        frame_origin: [m], shape (n, 3).
        axis: joint axis in the joint frame, shape (n, 3).
        prismatic: whether the joint slides, shape (n,).
    """

    position_index: np.ndarray
    velocity_index: np.ndarray
    parent_joint: np.ndarray
    frame_rotation: np.ndarray
    frame_origin: np.ndarray
    axis: np.ndarray
    prismatic: np.ndarray


@njit(cache=True)
def _rod_motion(joints: np.ndarray, q: np.ndarray, w: np.ndarray, out: np.ndarray) -> None:
    n = len(joints)
    for i in range(n):
        stroke, lever = stroke_and_lever(q[i], joints[i])
        out[i], out[n + i] = stroke, lever * w[i]


@njit(cache=True)
def _moments(joints: np.ndarray, q: np.ndarray, force: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(joints)):
        _, lever = stroke_and_lever(q[i], joints[i])
        out[i] = lever * force[i]


@njit(cache=True)
def _poses(
    q: np.ndarray,
    parent: np.ndarray,
    frame_rotation: np.ndarray,
    frame_origin: np.ndarray,
    axis: np.ndarray,
    prismatic: np.ndarray,
    rotation: np.ndarray,
    origin: np.ndarray,
) -> None:
    """World poses of the moving bodies by Rodrigues' formula along the tree."""
    for i in range(len(q)):
        a = axis[i]
        local = np.eye(3)
        shift = np.zeros(3)
        if prismatic[i]:
            shift = a * q[i]
        else:
            s, c = np.sin(q[i]), np.cos(q[i])
            cross = np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
            local = np.eye(3) + s * cross + (1.0 - c) * (cross @ cross)
        fixed_rotation, fixed_origin = frame_rotation[i], frame_origin[i]
        if parent[i] >= 0:
            up, at = rotation[parent[i]], origin[parent[i]]
            fixed_origin = at + up @ fixed_origin
            fixed_rotation = up @ fixed_rotation
        origin[i] = fixed_origin + fixed_rotation @ shift
        rotation[i] = fixed_rotation @ local


class Linkage(LeafSystem):
    """Joint motion to rod motion, and rod force back to forces at the mounting points.

    A cylinder between two neighbouring links pushes both along its axis; by virtual work that is the moment
    force times lever on its joint. Cylinders act through `mount_force` (thesis 4.2.4); vane, motor and any
    joint with play or a rocking base act through `moment`.

    Ports:
        in `plant_state` (all positions and velocities of the plant).
        in `side_motion` (2n): positions, then velocities of the actuator's side of each joint.
        in `rod_force` (n) [N].
        out `joint_motion` (2n): positions, then velocities of the joints [rad or m, 1/s].
        out `rod_motion` (2n): strokes, then velocities [m, m/s].
        out `moment` (n): force times lever [N m].
        out `mount_force`: list of forces on bodies, for the plant's `applied_spatial_force`.
    """

    def __init__(self, joints: np.ndarray, chain: Chain, mounts: list[Mount], states: int):
        """Build for the joints' records, the tree of bodies, the cylinders and the plant's number of states."""
        super().__init__()
        self.set_name("linkage")
        n = len(joints)
        self._joints = joints
        self._chain = chain
        self._mounts = mounts
        self._rotation = np.empty((n, 3, 3))
        self._origin = np.empty((n, 3))
        self._forces = self._force_templates()
        self.plant_state = self.DeclareVectorInputPort("plant_state", states)
        self.side = self.DeclareVectorInputPort("side_motion", 2 * n)
        self.force = self.DeclareVectorInputPort("rod_force", n)
        self.joint_motion = self.DeclareVectorOutputPort(
            "joint_motion", 2 * n, self._calc_joint_motion, prerequisites_of_calc={self.plant_state.ticket()}
        )
        self.rod_motion = self.DeclareVectorOutputPort(
            "rod_motion", 2 * n, self._calc_rod_motion, prerequisites_of_calc={self.side.ticket()}
        )
        both = {self.side.ticket(), self.force.ticket()}
        self.moment = self.DeclareVectorOutputPort("moment", n, self._calc_moment, prerequisites_of_calc=both)
        self.mount_force = self.DeclareAbstractOutputPort(
            "mount_force",
            lambda: Value[list[ExternallyAppliedSpatialForce]](),
            self._calc_mount_force,
            prerequisites_of_calc={self.plant_state.ticket(), self.force.ticket()},
        )

    def _force_templates(self) -> list[ExternallyAppliedSpatialForce]:
        forces = []
        for mount in self._mounts:
            for body, point in ((mount.child, mount.p_child), (mount.parent, mount.p_parent)):
                if body is not None:
                    force = ExternallyAppliedSpatialForce()
                    force.body_index = body
                    force.p_BoBq_B = point
                    forces.append(force)
        return forces

    def _calc_joint_motion(self, context: Context, output: BasicVector) -> None:
        state = self.plant_state.Eval(context)
        output.SetFromVector(
            np.concatenate([state[self._chain.position_index], state[self._chain.velocity_index]])
        )

    def _calc_rod_motion(self, context: Context, output: BasicVector) -> None:
        n = len(self._joints)
        side = self.side.Eval(context)
        motion = np.empty(2 * n)
        _rod_motion(self._joints, side[:n], side[n:], motion)
        output.SetFromVector(motion)

    def _calc_moment(self, context: Context, output: BasicVector) -> None:
        n = len(self._joints)
        moments = np.empty(n)
        _moments(self._joints, self.side.Eval(context)[:n], self.force.Eval(context), moments)
        output.SetFromVector(moments)

    def _calc_mount_force(self, context: Context, output: AbstractValue) -> None:
        chain = self._chain
        q = self.plant_state.Eval(context)[chain.position_index]
        force = self.force.Eval(context)
        _poses(
            q,
            chain.parent_joint,
            chain.frame_rotation,
            chain.frame_origin,
            chain.axis,
            chain.prismatic,
            self._rotation,
            self._origin,
        )
        templates = iter(self._forces)
        no_torque = np.zeros(3)
        for mount in self._mounts:
            i, up = mount.joint, chain.parent_joint[mount.joint]
            at_child = self._origin[i] + self._rotation[i] @ mount.p_child
            at_parent = mount.p_parent if up < 0 else self._origin[up] + self._rotation[up] @ mount.p_parent
            along = at_child - at_parent
            push = along * (force[i] / np.sqrt(along @ along))
            next(templates).F_Bq_W = SpatialForce(no_torque, push)
            if mount.parent is not None:
                next(templates).F_Bq_W = SpatialForce(no_torque, -push)
        output.set_value(self._forces)
