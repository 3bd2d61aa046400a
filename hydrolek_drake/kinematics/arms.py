"""The multibody plant of the Brokk base with both arms, from urdf/hydrolek.urdf, and one joint's load."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.geometry import Meshcat, MeshcatVisualizer, SceneGraph
from pydrake.math import RollPitchYaw, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable, RevoluteJoint
from pydrake.systems.framework import DiagramBuilder

import hydrolek_drake
from hydrolek_drake.errors import InputError

_MOVING_TYPES = ("revolute", "continuous")


@dataclass(frozen=True)
class ArmsPlant:
    """A finalized plant of the arms and the scene graph that knows its shapes."""

    plant: MultibodyPlant
    scene_graph: SceneGraph


@dataclass(frozen=True)
class RotatingLoad:
    """What one joint moves while all others are held: one rigid body turning about a fixed axis.

    J q'' + g_c cos(q) + g_s sin(q) = torque of the actuator

    The `_per_kg` fields are the increase for each kilogram of a point payload at the tool frame; they are
    zero for joint 7, which moves the jaw but not the tool frame.

    Attributes:
        inertia: J in kg m^2.
        gravity_cos: g_c in N m.
        gravity_sin: g_s in N m.
        inertia_per_kg: dJ/dm in m^2.
        gravity_cos_per_kg: dg_c/dm in N m / kg.
        gravity_sin_per_kg: dg_s/dm in N m / kg.
    """

    inertia: float
    gravity_cos: float
    gravity_sin: float
    inertia_per_kg: float
    gravity_cos_per_kg: float
    gravity_sin_per_kg: float


def arms_urdf_path() -> Path:
    """Path of `hydrolek.urdf`: inside an installed package, or at the top level of a clone.

    Raises:
        InputError: The file is in neither place.
    """
    package = Path(hydrolek_drake.__file__).resolve().parent
    candidates = (package / "urdf" / "hydrolek.urdf", package.parent / "urdf" / "hydrolek.urdf")
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise InputError(
        f"hydrolek.urdf is in neither {candidates[0].parent} nor {candidates[1].parent}; reinstall"
    )


def add_arms(
    builder: DiagramBuilder,
    *,
    time_step: float,
    meshcat: Meshcat | None = None,
    held: Mapping[str, float] | None = None,
    before_finalize: Callable[[MultibodyPlant], None] | None = None,
    collisions: bool = True,
) -> ArmsPlant:
    """Add base and both arms to a diagram, with gravity, finalized and connected.

    Args:
        builder: Diagram to add to; the systems are named `arms` and `scene_graph`.
        time_step: Step of the discrete plant in s; 0 for a continuous plant, which ignores joint limits.
        meshcat: Browser view to show the scene in, if any.
        held: Joints that do not move, with their angles in rad: they become welds.
        before_finalize: Adds to the plant what must be there before it is finalized.
        collisions: Whether the links may touch; looking for contact takes most of a step.

    Raises:
        InputError: `held` names a joint that the arms do not have, or `time_step` is negative.
    """
    if not 0.0 <= time_step < np.inf:
        raise InputError(f"time_step is {time_step} s; use 0 (continuous) or a positive step")
    model = _urdf_with_welds(held or {}, collisions)
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step)
    plant.set_name("arms")
    scene_graph.set_name("scene_graph")
    _parse(plant, model, before_finalize)
    if meshcat is not None:
        MeshcatVisualizer.AddToBuilder(builder, scene_graph, meshcat).set_name("meshcat_visualizer")
    return ArmsPlant(plant, scene_graph)


def make_arms_plant(held: Mapping[str, float] | None = None) -> MultibodyPlant:
    """A continuous plant of base and arms without shapes, for dynamics and kinematics.

    Args:
        held: Joints that do not move, with their angles in rad: they become welds, so that only the
            remaining joints are degrees of freedom.

    Raises:
        InputError: `held` names a joint that the arms do not have.
    """
    plant = MultibodyPlant(time_step=0.0)
    plant.set_name("arms")
    _parse(plant, _urdf_with_welds(held or {}))
    return plant


@cache
def arm_joint_names() -> tuple[str, ...]:
    """Names of all moving joints, from the URDF: `right_j1` to `right_j7`, `left_j1` to `left_j7`."""
    return tuple(
        joint.attrib["name"] for joint in _moving_joints(ElementTree.parse(arms_urdf_path()).getroot())
    )


def arm_joint(plant: MultibodyPlant, name: str) -> RevoluteJoint:
    """The moving joint called `name` of a plant of the arms.

    Raises:
        InputError: The plant has no such joint, or it is held.
    """
    joints = (plant.get_joint(index) for index in plant.GetJointIndices())
    moving = {joint.name(): joint for joint in joints if isinstance(joint, RevoluteJoint)}
    if name not in moving:
        raise InputError(f"joint '{name}' does not move in this plant; choose from {', '.join(moving)}")
    return moving[name]


def position_indices(plant: MultibodyPlant, names: Sequence[str]) -> list[int]:
    """Indices of the named joints in the plant's position vector (in its velocity vector they are the same).

    Raises:
        InputError: The plant has no such joint, or it is held.
    """
    return [arm_joint(plant, name).position_start() for name in names]


def load_of_joint(joint: str, held: Mapping[str, float]) -> RotatingLoad:
    """The load on one joint with the other joints of its arm held.

    J is the joint's diagonal entry of the mass matrix. The torque that balances gravity is a pure first
    harmonic of the joint's own angle, so its values at 0 and 90 degrees are g_c and g_s. The payload's
    share follows from the translational Jacobian j of the tool point: dJ/dm = |j|^2, and -j . gravity
    for the torque.

    Args:
        joint: Name of the moving joint, for example `right_j2`.
        held: Angles in rad of all other joints of the same arm; joints of the other arm may be named too
            and have no influence.

    Raises:
        InputError: `joint` or a name in `held` is unknown, or an angle of the same arm is missing.
    """
    plant = _plant_with_all_joints()
    names = arm_joint_names()
    if joint not in names:
        raise InputError(f"joint '{joint}' is not a joint of the arms; choose from {', '.join(names)}")
    side = joint.split("_")[0]
    missing = [name for name in names if name.startswith(side) and name != joint and name not in held]
    if missing:
        raise InputError(
            f"load of '{joint}': the angles of {', '.join(missing)} are missing in held; give each in rad"
        )
    context = plant.CreateDefaultContext()
    for name, angle in held.items():
        if name != joint:
            arm_joint(plant, name).set_angle(context, angle)
    moving = arm_joint(plant, joint)
    index = moving.velocity_start()
    tool = plant.GetFrameByName(f"{side}_tool")
    origin: Any = np.zeros(3)  # Any: the array types in pydrake's stubs match no array
    gravity = plant.gravity_field().gravity_vector()

    balance, payload_balance = [], []
    for angle in (0.0, np.pi / 2):
        moving.set_angle(context, angle)
        balance.append(-plant.CalcGravityGeneralizedForces(context)[index])
        jacobian = plant.CalcJacobianTranslationalVelocity(
            context, JacobianWrtVariable.kV, tool, origin, plant.world_frame(), plant.world_frame()
        )[:, index]
        payload_balance.append(-jacobian @ gravity)
    return RotatingLoad(
        inertia=float(plant.CalcMassMatrix(context)[index, index]),
        gravity_cos=float(balance[0]),
        gravity_sin=float(balance[1]),
        inertia_per_kg=float(jacobian @ jacobian),
        gravity_cos_per_kg=float(payload_balance[0]),
        gravity_sin_per_kg=float(payload_balance[1]),
    )


@cache
def _plant_with_all_joints() -> MultibodyPlant:
    return make_arms_plant()


def _parse(
    plant: MultibodyPlant, model: str, before_finalize: Callable[[MultibodyPlant], None] | None = None
) -> None:
    parser = Parser(plant)
    parser.package_map().AddPackageXml(arms_urdf_path().parent / "package.xml")
    parser.AddModelsFromString(model, "urdf")
    if before_finalize is not None:
        before_finalize(plant)
    plant.Finalize()


def _urdf_with_welds(held: Mapping[str, float], collisions: bool = True) -> str:
    """The URDF's text with each held joint turned into a weld at its angle, without collision shapes on wish."""
    if not held and collisions:
        return arms_urdf_path().read_text(encoding="utf-8")
    robot = ElementTree.parse(arms_urdf_path()).getroot()
    joints = {joint.attrib["name"]: joint for joint in _moving_joints(robot)}
    for name, angle in held.items():
        if name not in joints:
            raise InputError(
                f"held joint '{name}' is not a joint of the arms; choose from {', '.join(joints)}"
            )
        if not np.isfinite(angle):
            raise InputError(f"held joint '{name}' has angle {angle}; give a number in rad")
        _weld(joints[name], angle)
    if not collisions:
        for link in robot.iter("link"):
            for shape in link.findall("collision"):
                link.remove(shape)
    return ElementTree.tostring(robot, encoding="unicode")


def _weld(joint: ElementTree.Element, angle: float) -> None:
    origin, axis = joint.find("origin"), joint.find("axis")
    assert origin is not None and axis is not None  # every moving joint of the URDF states both
    at_zero = RotationMatrix(RollPitchYaw(_numbers(origin.get("rpy", "0 0 0"))))
    turned = at_zero @ RotationMatrix(AngleAxis(angle, _numbers(axis.attrib["xyz"])))
    origin.set("rpy", " ".join(f"{value:.17g}" for value in RollPitchYaw(turned).vector()))
    joint.set("type", "fixed")
    joint.remove(axis)


def _moving_joints(robot: ElementTree.Element) -> list[ElementTree.Element]:
    return [joint for joint in robot.iter("joint") if joint.get("type") in _MOVING_TYPES]


def _numbers(text: str) -> Any:  # Any: the array types in pydrake's stubs match no array
    return np.array([float(word) for word in text.split()])
