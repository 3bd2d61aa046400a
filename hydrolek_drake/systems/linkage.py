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
def _rod_motion(joints: np.ndarray, state: np.ndarray, q: np.ndarray, w: np.ndarray, out: np.ndarray) -> None:
    """`q` and `w` say where each joint's position and velocity stand in `state`."""
    n = len(joints)
    for i in range(n):
        stroke, lever = stroke_and_lever(state[q[i]], joints[i])
        out[i], out[n + i] = stroke, lever * state[w[i]]


@njit(cache=True)
def _moments(
    joints: np.ndarray, state: np.ndarray, q: np.ndarray, force: np.ndarray, out: np.ndarray
) -> None:
    for i in range(len(joints)):
        _, lever = stroke_and_lever(state[q[i]], joints[i])
        out[i] = lever * force[i]


@njit(cache=True)
def _pushes(
    state: np.ndarray,
    position_index: np.ndarray,
    force: np.ndarray,
    parent: np.ndarray,
    frame_rotation: np.ndarray,
    frame_origin: np.ndarray,
    axis: np.ndarray,
    prismatic: np.ndarray,
    mount_joint: np.ndarray,
    p_parent: np.ndarray,
    p_child: np.ndarray,
    out: np.ndarray,
) -> None:
    """Each cylinder's force [N] on its child body in the world frame, shape (mounts, 3).

    World poses of the moving bodies by Rodrigues' formula along the tree, then the unit vector between mounts.
    """
    n = len(position_index)
    rotation = np.empty((n, 3, 3))
    origin = np.empty((n, 3))
    turn = np.empty((3, 3))
    for i in range(n):
        a = axis[i]
        up = parent[i]
        for r in range(3):
            for c in range(3):
                turn[r, c] = 1.0 if r == c else 0.0
        q = state[position_index[i]]
        slide = q if prismatic[i] else 0.0
        if not prismatic[i]:
            sin, cos = np.sin(q), np.cos(q)
            for r in range(3):
                for c in range(3):
                    turn[r, c] = cos * turn[r, c] + (1.0 - cos) * a[r] * a[c]
            turn[0, 1] -= sin * a[2]
            turn[0, 2] += sin * a[1]
            turn[1, 0] += sin * a[2]
            turn[1, 2] -= sin * a[0]
            turn[2, 0] -= sin * a[1]
            turn[2, 1] += sin * a[0]
        for r in range(3):
            origin[i, r] = frame_origin[i, r]
            for c in range(3):
                rotation[i, r, c] = 0.0
                for k in range(3):
                    rotation[i, r, c] += frame_rotation[i, r, k] * turn[k, c]
                origin[i, r] += frame_rotation[i, r, c] * a[c] * slide
        if up >= 0:
            own_rotation, own_origin = rotation[i].copy(), origin[i].copy()
            for r in range(3):
                origin[i, r] = origin[up, r]
                for c in range(3):
                    rotation[i, r, c] = 0.0
                    origin[i, r] += rotation[up, r, c] * own_origin[c]
                    for k in range(3):
                        rotation[i, r, c] += rotation[up, r, k] * own_rotation[k, c]
    along = np.empty(3)
    for m in range(len(mount_joint)):
        i = mount_joint[m]
        up = parent[i]
        square = 0.0
        for r in range(3):
            along[r] = origin[i, r]
            if up >= 0:
                along[r] -= origin[up, r]
            else:
                along[r] -= p_parent[m, r]
            for c in range(3):
                along[r] += rotation[i, r, c] * p_child[m, c]
                if up >= 0:
                    along[r] -= rotation[up, r, c] * p_parent[m, c]
            square += along[r] * along[r]
        scale = force[i] / np.sqrt(square)
        for r in range(3):
            out[m, r] = along[r] * scale


class Linkage(LeafSystem):
    """Joint motion to rod motion, and rod force back to forces at the mounting points.

    A cylinder between two neighbouring links pushes both along its axis; by virtual work that is the moment
    force times lever on its joint. Cylinders act through `mount_force` (thesis 4.2.4); vane, motor and any
    joint with play or a rocking base act through `moment`.

    Ports:
        in `plant_state` (all positions and velocities of the plant).
        in `side_motion` (2n): positions, then velocities of the actuator's side of each joint; open if that is
            the joint itself.
        in `rod_force` (n) [N].
        out `joint_motion` (2n): positions, then velocities of the joints [rad or m, 1/s].
        out `rod_motion` (2n): strokes, then velocities [m, m/s].
        out `moment` (n): force times lever [N m].
        out `mount_force`: list of forces on bodies, for the plant's `applied_spatial_force`.
    """

    def __init__(self, joints: np.ndarray, chain: Chain, mounts: list[Mount], states: int, has_side: bool):
        """Build the system.

        Args:
            joints: records, shape (n,).
            chain: the tree of moving bodies.
            mounts: the cylinders that act at their mounting points.
            states: the plant's number of positions and velocities.
            has_side: whether `side_motion` is connected (play or a rocking base).
        """
        super().__init__()
        self.set_name("linkage")
        n = len(joints)
        self._joints = joints
        self._chain = chain
        self._mounts = mounts
        self._mount_joint = np.array([mount.joint for mount in mounts], dtype=np.int64)
        self._p_parent = np.array([mount.p_parent for mount in mounts]).reshape(-1, 3)
        self._p_child = np.array([mount.p_child for mount in mounts]).reshape(-1, 3)
        self._forces = self._force_templates()
        self.plant_state = self.DeclareVectorInputPort("plant_state", states)
        self.side = self.DeclareVectorInputPort("side_motion", 2 * n)
        self.force = self.DeclareVectorInputPort("rod_force", n)
        self.joint_motion = self.DeclareVectorOutputPort(
            "joint_motion", 2 * n, self._calc_joint_motion, prerequisites_of_calc={self.plant_state.ticket()}
        )
        source = self.side if has_side else self.plant_state
        self._source = source
        self._q = np.arange(n) if has_side else chain.position_index
        self._w = np.arange(n, 2 * n) if has_side else chain.velocity_index
        self.rod_motion = self.DeclareVectorOutputPort(
            "rod_motion", 2 * n, self._calc_rod_motion, prerequisites_of_calc={source.ticket()}
        )
        both = {source.ticket(), self.force.ticket()}
        self.moment = self.DeclareVectorOutputPort("moment", n, self._calc_moment, prerequisites_of_calc=both)
        self.mount_force = self.DeclareAbstractOutputPort(
            "mount_force",
            lambda: Value[list[ExternallyAppliedSpatialForce]](),
            self._calc_mount_force,
            prerequisites_of_calc={self.plant_state.ticket(), self.force.ticket()},
        )

    def _force_templates(self) -> list[ExternallyAppliedSpatialForce]:
        forces, rows, signs = [], [], []
        for row, mount in enumerate(self._mounts):
            for body, point, sign in (
                (mount.child, mount.p_child, 1.0),
                (mount.parent, mount.p_parent, -1.0),
            ):
                if body is not None:
                    force = ExternallyAppliedSpatialForce()
                    force.body_index = body
                    force.p_BoBq_B = point
                    forces.append(force)
                    rows.append(row)
                    signs.append(sign)
        self._row = np.array(rows, dtype=int)
        self._sign = np.array(signs).reshape(-1, 1)
        return forces

    def _calc_joint_motion(self, context: Context, output: BasicVector) -> None:
        state = self.plant_state.Eval(context)
        output.SetFromVector(
            np.concatenate([state[self._chain.position_index], state[self._chain.velocity_index]])
        )

    def _calc_rod_motion(self, context: Context, output: BasicVector) -> None:
        _rod_motion(self._joints, self._source.Eval(context), self._q, self._w, output.get_mutable_value())

    def _calc_moment(self, context: Context, output: BasicVector) -> None:
        state, force = self._source.Eval(context), self.force.Eval(context)
        _moments(self._joints, state, self._q, force, output.get_mutable_value())

    def _calc_mount_force(self, context: Context, output: AbstractValue) -> None:
        chain = self._chain
        pushes = np.empty((len(self._mounts), 3))
        _pushes(
            self.plant_state.Eval(context),
            chain.position_index,
            self.force.Eval(context),
            chain.parent_joint,
            chain.frame_rotation,
            chain.frame_origin,
            chain.axis,
            chain.prismatic,
            self._mount_joint,
            self._p_parent,
            self._p_child,
            pushes,
        )
        no_torque = np.zeros(3)
        for force, push in zip(self._forces, list(pushes[self._row] * self._sign), strict=True):
            force.F_Bq_W = SpatialForce(no_torque, push)
        output.set_value(self._forces)
