"""The tree of moving bodies and the cylinders' mounting points, read off a finalized plant."""

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, Joint, PrismaticJoint

from hydrolek_drake.physics import cylinder, linkage
from hydrolek_drake.systems.linkage import Chain, Mount


def read_chain(plant: MultibodyPlant, names: tuple[str, ...]) -> Chain:
    """The named joints as a tree, in the order given, which must run from the base outwards."""
    context = plant.CreateDefaultContext()
    joints = [plant.GetJointByName(name) for name in names]
    child_of = {int(joint.child_body().index()): i for i, joint in enumerate(joints)}
    parents, rotations, origins, axes = [], [], [], []
    for joint in joints:
        up = _carrier(plant, joint.parent_body().index(), child_of)
        joint_frame = joint.frame_on_parent().CalcPoseInWorld(context)
        below = RigidTransform()
        if up >= 0:
            below = joints[up].frame_on_child().CalcPoseInWorld(context)
        fixed = below.inverse() @ joint_frame
        parents.append(up)
        rotations.append(fixed.rotation().matrix())
        origins.append(fixed.translation())
        axes.append(_axis(joint))
    positions = plant.num_positions()
    return Chain(
        position_index=np.array([joint.position_start() for joint in joints]),
        velocity_index=np.array([positions + joint.velocity_start() for joint in joints]),
        parent_joint=np.array(parents),
        frame_rotation=np.ascontiguousarray(rotations),
        frame_origin=np.ascontiguousarray(origins),
        axis=np.ascontiguousarray(axes),
        prismatic=np.array([isinstance(joint, PrismaticJoint) for joint in joints]),
    )


def read_mounts(
    plant: MultibodyPlant, names: tuple[str, ...], joints: np.ndarray, chain: Chain
) -> list[Mount]:
    """Mounting points of the linear cylinders, from each linkage's triangle.

    The fixed mount stands at `mount_angle` around the joint axis from an in-plane axis e1 (for a Z axis e1 = X,
    for Y e1 = Z, for X e1 = Y), the moving one at mount_angle + direction * angle_offset in the child's frame.
    """
    mounts = []
    for i, name in enumerate(names):
        record = joints[i]
        if (
            record["linkage"]["variant"] != linkage.TRIANGLE
            or record["cylinder"]["variant"] != cylinder.CYLINDER
        ):
            continue
        parent_point, child_point = mount_points(record, chain.axis[i])
        joint = plant.GetJointByName(name)
        up = int(chain.parent_joint[i])
        on_parent = RigidTransform(RotationMatrix(chain.frame_rotation[i]), chain.frame_origin[i])
        mounts.append(
            Mount(
                joint=i,
                parent=None if up < 0 else _body_index(plant.GetJointByName(names[up])),
                child=_body_index(joint),
                p_parent=on_parent @ parent_point,
                p_child=child_point,
            )
        )
    return mounts


def mount_points(record: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A cylinder's mounts in its joint's frame on the parent and on the child side [m]."""
    p = record["linkage"]
    first = np.roll(axis, 1)  # Z -> X, Y -> Z, X -> Y: the in-plane axis e1
    second = np.cross(axis, first)
    fixed = float(p["mount_angle"])
    moving = fixed + float(p["direction"] * p["angle_offset"])
    along = float(p["axial_offset"]) * axis
    at_parent = float(p["distance_parent"]) * (np.cos(fixed) * first + np.sin(fixed) * second) + along
    at_child = float(p["distance_child"]) * (np.cos(moving) * first + np.sin(moving) * second) + along
    return at_parent, at_child


def _carrier(plant: MultibodyPlant, body: BodyIndex, child_of: dict[int, int]) -> int:
    """The moving joint whose body carries `body` through welds, -1 for the world."""
    for welded in plant.GetBodiesWeldedTo(plant.get_body(body)):
        if int(welded.index()) in child_of:
            return child_of[int(welded.index())]
    return -1


def _axis(joint: Joint) -> np.ndarray:
    if isinstance(joint, PrismaticJoint):
        return np.array(joint.translation_axis())
    return np.array(joint.revolute_axis())


def _body_index(joint: Joint) -> BodyIndex:
    return joint.child_body().index()
