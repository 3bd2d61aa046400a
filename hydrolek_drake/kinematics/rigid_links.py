"""The arms' links as numbers, from the plant that the Diagram has, for the compiled equation of motion."""

from collections.abc import Mapping, Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody

from hydrolek_drake.kinematics.arms import arm_joint, arm_joint_names, make_arms_plant
from hydrolek_drake.physics.bodies.mass_matrix import ROOT
from hydrolek_drake.physics.bodies.serial_arm import link


def rigid_links(joints: Sequence[str], held: Mapping[str, float]) -> np.ndarray:
    """Rows of `serial_arm.link` for the links that turn about some joints of the arms; all other joints are held.

    Args:
        joints: that move, each after those that carry it.
        held: angles in rad of joints that do not move; those that are not named are held at zero.

    Returns:
        # (joints, 36)

    Raises:
        InputError: a name is none of the arms' joints.
    """
    still = {name: held.get(name, 0.0) for name in arm_joint_names() if name not in joints}
    plant = make_arms_plant(still)
    context = plant.CreateDefaultContext()
    for name in joints:
        arm_joint(plant, name).set_angle(context, 0.0)
    moving = [arm_joint(plant, name) for name in joints]
    rows = {joint.child_body().index(): i for i, joint in enumerate(moving)}
    found = []
    for joint in moving:
        carrying = _moving_body(plant, joint.parent_body(), rows)
        frame = joint.frame_on_child()
        at = joint.frame_on_parent()
        parent = ROOT if carrying is None else rows[carrying.index()]
        before = plant.world_frame() if carrying is None else moving[parent].frame_on_child()
        pose = at.CalcPose(context, before)
        welded = plant.GetBodiesWeldedTo(joint.child_body())
        inertia = plant.CalcSpatialInertia(context, frame, [body.index() for body in welded])
        tool = plant.GetFrameByName(f"{joint.name().split('_')[0]}_tool")
        carries = tool.body().index() in {body.index() for body in welded}
        found.append(
            link(
                parent,
                pose.rotation().matrix(),
                pose.translation(),
                joint.revolute_axis(),
                inertia.get_mass(),
                inertia.get_mass() * inertia.get_com(),
                inertia.CopyToFullMatrix6()[:3, :3],
                np.array(plant.gravity_field().gravity_vector()),
                tool.CalcPose(context, frame).translation() if carries else None,
            )
        )
    return np.array(found)


def _moving_body(plant: MultibodyPlant, body: RigidBody, rows: Mapping[object, int]) -> RigidBody | None:
    """The body that turns, to which a body is welded; None for the base."""
    return next((other for other in plant.GetBodiesWeldedTo(body) if other.index() in rows), None)
