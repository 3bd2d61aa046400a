"""The MultibodyPlant of a rig: the arms from their URDF, or one simple body for each joint."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from pydrake.geometry import Cylinder, SceneGraph
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    Frame,
    PrismaticJoint,
    RevoluteJoint,
    RigidBody,
    SpatialInertia,
    UnitInertia,
    default_model_instance,
)
from pydrake.systems.framework import DiagramBuilder

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import add_arms, arm_joint_names
from hydrolek_drake.physics import load
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout import one_point

_AXIS = np.array([0.0, 0.0, 1.0])
_UPRIGHT = RollPitchYaw(math.pi / 2.0, 0.0, 0.0)  # a joint's plane: X forward, Y up, as the arms' base frames

_REACH, _HEAVIEST = (
    (1e-9, 1e15),
    1e15,
)  # m, kg; a joint that is nearly balanced has its centre of gravity far off


@dataclass(frozen=True)
class Payload:
    """A body at a joint's tool whose mass appears at a time."""

    body: RigidBody
    mass: float
    time: float


@dataclass(frozen=True)
class RigPlant:
    """A finalized plant whose moving joints carry the rig's names."""

    plant: MultibodyPlant
    scene_graph: SceneGraph
    payloads: tuple[Payload, ...]


def add_plant(builder: DiagramBuilder, rig: Rig, joints: np.ndarray, time_step: float) -> RigPlant:
    """Add the rig's bodies to a diagram.

    Args:
        builder: diagram to add to.
        rig: names the joints.
        joints: their records, shape (n,).
        time_step: of a discrete plant [s]; 0 for a continuous one.

    Raises:
        InputError: an inertia or gravity moment that no body has.
    """
    payloads: list[Payload] = []
    if rig.variant(rig.joints[0], "load") == "arm":
        carrying: set[str] = set()

        def finish(plant: MultibodyPlant) -> None:
            for name, joint in zip(rig.joints, joints, strict=True):
                _add_rod_inertia(plant, name, joint)
                side = name.split("_")[0]
                if side in carrying:  # all joints of an arm feel the same payload; it hangs there once
                    continue
                tool = plant.GetFrameByName(f"{side}_tool")
                added = _payload(plant, name, joint, partial(_weld_to, plant, tool))
                carrying.update({side} if added else ())
                payloads.extend(added)

        others = {name: 0.0 for name in arm_joint_names() if name not in rig.joints}
        arms = add_arms(
            builder,
            time_step=time_step,
            held={**others, **rig.held},
            before_finalize=finish,
            collisions=time_step > 0.0,  # the discrete plant is there for contact
        )
        return RigPlant(arms.plant, arms.scene_graph, tuple(payloads))
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step)
    plant.set_name("plant")
    scene_graph.set_name("scene_graph")
    for name, joint in zip(rig.joints, joints, strict=True):
        payloads.extend(_add_simple_joint(plant, name, joint))
        _add_rod_inertia(plant, name, joint)
    plant.Finalize()
    return RigPlant(plant, scene_graph, tuple(payloads))


def _add_simple_joint(plant: MultibodyPlant, name: str, joint: np.ndarray) -> list[Payload]:
    """A sliding mass, or a turning body with the record's inertia and gravity moment."""
    p = joint["load"]
    if p["variant"] == load.SLIDING:
        body = plant.AddRigidBody(
            f"{name}_body", SpatialInertia(float(p["inertia"]), np.zeros(3), UnitInertia.SolidCube(0.1))
        )
        plant.AddJoint(
            PrismaticJoint(name, plant.world_frame(), body.body_frame(), np.array([1.0, 0.0, 0.0]))
        )
        return _payload(
            plant, name, joint, lambda added: plant.WeldFrames(body.body_frame(), added.body_frame())
        )
    gravity = plant.gravity_field().gravity_vector()
    g = float(np.linalg.norm(gravity))
    inertia = one_point.own_inertia(joint)
    gravity_cos, gravity_sin = one_point.gravity_moments(joint)
    moment = math.hypot(gravity_cos, gravity_sin)
    if moment > 0.0:
        # Half of the inertia as a point mass at the centre of gravity, half about it: any such body has the
        # same equation of motion, and this one is physically possible.
        arm = 0.5 * inertia * g / moment
        mass = moment / (g * arm)
        if not (_REACH[0] <= arm <= _REACH[1] and mass <= _HEAVIEST):
            raise InputError(
                f"joints.{name}.load: an inertia of {inertia:g} kg m^2 and a gravity moment of {moment:g} N m "
                f"make no body: {mass:g} kg at {arm:g} m"
            )
        angle = math.atan2(-gravity_sin, gravity_cos)
        centre = arm * np.array([math.cos(angle), math.sin(angle), 0.0])
        about_centre = UnitInertia.SolidSphere(math.sqrt(2.5 * 0.5 * inertia / mass))
        spatial = SpatialInertia.MakeFromCentralInertia(mass, centre, about_centre * mass)
    else:
        if not _REACH[0] <= math.sqrt(inertia) <= _REACH[1]:
            raise InputError(f"joints.{name}.load: an inertia of {inertia:g} kg m^2 is no machine's")
        spatial = SpatialInertia(1.0, np.zeros(3), UnitInertia.SolidSphere(math.sqrt(2.5 * inertia)))
        centre = np.array([0.5, 0.0, 0.0])
    body = plant.AddRigidBody(f"{name}_body", spatial)
    frame = plant.AddFrame(
        FixedOffsetFrame(f"{name}_frame", plant.world_frame(), RigidTransform(_UPRIGHT, np.zeros(3)))
    )
    plant.AddJoint(RevoluteJoint(name, frame, body.body_frame(), _AXIS))
    length = float(np.linalg.norm(centre))
    along = RigidTransform(RollPitchYaw(0.0, math.pi / 2.0, math.atan2(centre[1], centre[0])), centre / 2.0)
    plant.RegisterVisualGeometry(
        body, along, Cylinder(0.04 * length, length), f"{name}_link", np.array([0.9, 0.7, 0.1, 1.0])
    )
    radius = math.sqrt(max(float(p["payload_inertia"]), 0.0))
    angle = math.atan2(-p["payload_gravity_sin"], p["payload_gravity_cos"])
    tip = RigidTransform(radius * np.array([math.cos(angle), math.sin(angle), 0.0]))
    return _payload(
        plant, name, joint, lambda added: plant.WeldFrames(body.body_frame(), added.body_frame(), tip)
    )


def _weld_to(plant: MultibodyPlant, frame: Frame, body: RigidBody) -> None:
    plant.WeldFrames(frame, body.body_frame())


def _payload(
    plant: MultibodyPlant, name: str, joint: np.ndarray, weld: Callable[[RigidBody], object]
) -> list[Payload]:
    effect = joint["effects"]["load_payload"]
    mass = float(effect["mass_kg"])
    if mass == 0.0:
        return []
    body = plant.AddRigidBody(
        f"{name}_payload",
        default_model_instance(),
        SpatialInertia(mass, np.zeros(3), UnitInertia(0.0, 0.0, 0.0)),
    )
    weld(body)
    return [Payload(body, mass, float(effect["time_s"]))]


def _add_rod_inertia(plant: MultibodyPlant, name: str, joint: np.ndarray) -> None:
    inertia = load.reflected_rod_inertia(joint)
    if inertia > 0.0:
        actuator = plant.AddJointActuator(f"{name}_rod", plant.GetJointByName(name))
        actuator.set_default_rotor_inertia(inertia)
        actuator.set_default_gear_ratio(1.0)
