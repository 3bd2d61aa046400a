"""What moves: the MultibodyPlant with cylinders that push, links that play and a base that rocks."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import Propeller, PropellerInfo
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import DiagramBuilder, OutputPort
from pydrake.systems.primitives import Adder, Gain

from hydrolek_drake.physics import cylinder, linkage
from hydrolek_drake.rigs import Rig
from hydrolek_drake.station.chain import read_chain, read_mounts
from hydrolek_drake.station.plant import RigPlant
from hydrolek_drake.station.step_sizes import StepSizes
from hydrolek_drake.systems.linkage import Linkage
from hydrolek_drake.systems.load import Load
from hydrolek_drake.systems.play import Play
from hydrolek_drake.systems.rocking_base import RockingBase

Add = Callable[[Any], Any]
"""Adds a system to the diagram and returns it."""


@dataclass(frozen=True)
class Mechanics:
    """What the rest of the diagram is wired to.

    Attributes:
        linkage: takes the rods' forces, and tells the motion of rods and joints.
        sensed: motion of the joints that their sensors see.
    """

    linkage: Linkage
    sensed: OutputPort


def wire_mechanics(
    builder: DiagramBuilder, add: Add, rig: Rig, joints: np.ndarray, body: RigPlant, sizes: StepSizes
) -> Mechanics:
    """Add the systems between the plant and the actuators, and wire them.

    Args:
        builder: of the diagram that has the plant.
        add: adds a system and keeps it by its name.
        rig: the machine.
        joints: its records.
        body: the plant.
        sizes: whether cylinders push at their mounting points.
    """
    plant = body.plant
    chain = read_chain(plant, rig.joints)
    playing = joints["effects"]["linkage_backlash"]["gap_rad"] > 0.0
    rocking = joints["effects"]["base_compliance"]["stiffness_Nm_per_rad"] > 0.0
    is_cylinder = (joints["linkage"]["variant"] == linkage.TRIANGLE) & (
        joints["cylinder"]["variant"] == cylinder.CYLINDER
    )
    by_moment = playing | rocking | ~is_cylinder | (not sizes.mount_forces)
    mounts = [mount for mount in read_mounts(plant, rig.joints, joints, chain) if not by_moment[mount.joint]]
    has_side = bool(playing.any() or rocking.any())
    link = add(Linkage(joints, chain, mounts, plant.num_multibody_states(), has_side))
    load = add(Load(joints, chain, plant.num_velocities(), by_moment))
    builder.Connect(plant.get_state_output_port(), link.plant_state)
    if mounts:
        pushers = add(_pushers(link.ends))
        builder.Connect(link.mount_force, pushers.get_command_input_port())
        builder.Connect(plant.get_body_poses_output_port(), pushers.get_body_poses_input_port())
        builder.Connect(
            pushers.get_spatial_forces_output_port(), plant.get_applied_spatial_force_input_port()
        )
    builder.Connect(plant.get_state_output_port(), load.plant_state)
    builder.Connect(load.torque, plant.get_applied_generalized_force_input_port())
    side, sensed, moment = link.joint_motion, link.joint_motion, link.moment
    if playing.any():
        play = add(Play(joints))
        builder.Connect(link.joint_motion, play.motion)
        builder.Connect(link.moment, play.moment)
        side, moment = play.side, play.transmitted
    if rocking.any():
        base = add(RockingBase(joints))
        builder.Connect(link.moment, base.moment)
        builder.Connect(side, base.motion)
        side = base.relative
        sensed = side
        if playing.any():  # the sensor sits on the link, not on the actuator's side of the play
            less = builder.AddNamedSystem("tilt_reversed", Gain(-1.0, 2 * len(joints)))
            relative = builder.AddNamedSystem("link_less_tilt", Adder(2, 2 * len(joints)))
            builder.Connect(base.tilt, less.get_input_port())
            builder.Connect(link.joint_motion, relative.get_input_port(0))
            builder.Connect(less.get_output_port(), relative.get_input_port(1))
            sensed = relative.get_output_port()
    if has_side:
        builder.Connect(side, link.side)
    if by_moment.any():
        builder.Connect(moment, load.moment)
    return Mechanics(link, sensed)


def _pushers(ends: list[tuple[BodyIndex, np.ndarray]]) -> Propeller:
    """Drake's own system that puts forces on bodies, here without any spin: three along the axes of each mount.

    Forces as Python objects would take longer than all else that is done in a step.
    """
    axes = [RotationMatrix.MakeFromOneVector(axis, axis_index=2) for axis in np.eye(3)]
    pushers = Propeller(
        [PropellerInfo(body, RigidTransform(axis, point)) for body, point in ends for axis in axes]
    )
    pushers.set_name("mounts")
    return pushers
