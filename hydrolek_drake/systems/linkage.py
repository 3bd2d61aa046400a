"""The linkages of every joint: stroke and lever, and the cylinders' forces at their mounting points."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from pydrake.multibody.tree import BodyIndex
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
    parent: BodyIndex | None
    child: BodyIndex
    p_parent: np.ndarray
    p_child: np.ndarray


@dataclass(frozen=True)
class Chain:
    """The moving bodies as a tree, in the rig's order of joints; enough to turn forces into the bodies' frames.

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
    frame_rotation: np.ndarray,
    frame_origin: np.ndarray,
    axis: np.ndarray,
    prismatic: np.ndarray,
    mount_joint: np.ndarray,
    p_parent: np.ndarray,
    p_child: np.ndarray,
    child_end: np.ndarray,
    parent_end: np.ndarray,
    out: np.ndarray,
) -> None:
    """Each cylinder's force [N] on its two bodies, each in that body's frame, along the line between the mounts.

    `child_end` and `parent_end` say which three of `out` an end has; -1 for one on a body that never moves. The
    joint turns the child's frame against the parent's by Rodrigues' formula.
    """
    turned = np.empty((3, 3))
    along = np.empty(3)
    for m in range(len(mount_joint)):
        i = mount_joint[m]
        a = axis[i]
        fixed = frame_rotation[i]
        q = state[position_index[i]]
        sin, cos, slide = np.sin(q), np.cos(q), 0.0
        if prismatic[i]:
            sin, cos, slide = 0.0, 1.0, q
        for r in range(3):
            on_axis = fixed[r, 0] * a[0] + fixed[r, 1] * a[1] + fixed[r, 2] * a[2]
            for c in range(3):
                next_c, last_c = (c + 1) % 3, (c + 2) % 3
                crossed = fixed[r, next_c] * a[last_c] - fixed[r, last_c] * a[next_c]
                turned[r, c] = cos * fixed[r, c] + (1.0 - cos) * on_axis * a[c] + sin * crossed
            along[r] = frame_origin[i, r] + on_axis * slide - p_parent[m, r]
        square = 0.0
        for r in range(3):
            for c in range(3):
                along[r] += turned[r, c] * p_child[m, c]
            square += along[r] * along[r]
        scale = force[i] / np.sqrt(square)
        for r in range(3):
            if parent_end[m] >= 0:
                out[3 * parent_end[m] + r] = -scale * along[r]
            child = 0.0
            for c in range(3):
                child += turned[c, r] * along[c]
            out[3 * child_end[m] + r] = scale * child


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
        out `mount_force` (3 per entry of `ends`): force on each mount [N] in its body's frame.
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
        self._mount_joint = np.array([mount.joint for mount in mounts], dtype=np.int64)
        self._p_parent = np.array([mount.p_parent for mount in mounts]).reshape(-1, 3)
        self._p_child = np.array([mount.p_child for mount in mounts]).reshape(-1, 3)
        self.ends: list[tuple[BodyIndex, np.ndarray]] = []
        """Body index and mount in its frame [m] of each end that `mount_force` pushes."""
        self._child_end = np.array([self._add_end(mount.child, mount.p_child) for mount in mounts], np.int64)
        self._parent_end = np.array(
            [self._add_end(mount.parent, mount.p_parent) for mount in mounts], np.int64
        )
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
        self.mount_force = self.DeclareVectorOutputPort(
            "mount_force",
            3 * len(self.ends),
            self._calc_mount_force,
            prerequisites_of_calc={self.plant_state.ticket(), self.force.ticket()},
        )

    def _add_end(self, body: BodyIndex | None, point: np.ndarray) -> int:
        if body is None:
            return -1
        self.ends.append((body, point))
        return len(self.ends) - 1

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

    def _calc_mount_force(self, context: Context, output: BasicVector) -> None:
        chain = self._chain
        _pushes(
            self.plant_state.Eval(context),
            chain.position_index,
            self.force.Eval(context),
            chain.frame_rotation,
            chain.frame_origin,
            chain.axis,
            chain.prismatic,
            self._mount_joint,
            self._p_parent,
            self._p_child,
            self._child_end,
            self._parent_end,
            output.get_mutable_value(),
        )
