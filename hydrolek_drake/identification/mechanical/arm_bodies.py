"""The links of one arm as the mechanical model needs them, taken from the MultibodyPlant."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from hydrolek_drake.physics.bodies.serial_arm import link

JOINTS = 6


@dataclass(frozen=True)
class ArmBodies:
    """Geometry of joints 1 to 6 and what a kilogram of each link, and the jaw, add to the inertia.

    Attributes:
        offsets: each joint's place in the link before it [m]. # (6, 3)
        axes: each joint's axis, unit vectors. # (6, 3)
        moments_per_kg: centre of mass of each link [m]. # (6, 3)
        inertias_per_kg: about the joint's place, per kilogram [m^2]. # (6, 3, 3)
        jaw_mass: of the jaw, which is closed and moves with link 6 [kg].
        jaw_moment: its mass times centre of mass in link 6 [kg m]. # (3,)
        jaw_inertia: its inertia about joint 6, in link 6 [kg m^2]. # (3, 3)
    """

    offsets: np.ndarray
    axes: np.ndarray
    moments_per_kg: np.ndarray
    inertias_per_kg: np.ndarray
    jaw_mass: float
    jaw_moment: np.ndarray
    jaw_inertia: np.ndarray

    def with_masses(self, masses: np.ndarray, gravity: float) -> np.ndarray:
        """Rows of `serial_arm.link`: shapes stay while masses scale; the jaw is added. # (6, 36).

        Args:
            masses: of links 1 to 6 [kg]. # (6,)
            gravity: along -Y of the arm's base [m/s^2].
        """
        moments = masses[:, None] * self.moments_per_kg
        inertias = masses[:, None, None] * self.inertias_per_kg
        total, down = masses.astype(float), np.array([0.0, -gravity, 0.0])
        total[-1] += self.jaw_mass
        moments[-1] += self.jaw_moment
        inertias[-1] += self.jaw_inertia
        return np.array(
            [
                link(k - 1, np.eye(3), self.offsets[k], self.axes[k], total[k], moments[k], inertias[k], down)
                for k in range(JOINTS)
            ]
        )


@cache
def arm_bodies(side: str = "right") -> ArmBodies:
    """Bodies of one arm of urdf/hydrolek.urdf."""
    from hydrolek_drake.kinematics.arms import arm_joint, make_arms_plant

    plant = make_arms_plant()
    context = plant.CreateDefaultContext()
    offsets, axes, moments, inertias = [], [], [], []
    for number in range(1, JOINTS + 1):
        joint = arm_joint(plant, f"{side}_j{number}")
        offsets.append(joint.frame_on_parent().GetFixedPoseInBodyFrame().translation())
        axes.append(joint.revolute_axis())
        inertia: Any = plant.GetBodyByName(f"{side}_link{number}").CalcSpatialInertiaInBodyFrame(context)
        moments.append(inertia.get_com())
        inertias.append(inertia.get_unit_inertia().CopyToFullMatrix3())
    jaw_body = plant.GetBodyByName(f"{side}_jaw")
    hand = plant.GetFrameByName(f"{side}_link6")
    pose = plant.CalcRelativeTransform(context, hand, jaw_body.body_frame())
    jaw: Any = jaw_body.CalcSpatialInertiaInBodyFrame(context).ReExpress(pose.rotation())
    jaw = jaw.Shift(-pose.translation())
    return ArmBodies(
        offsets=np.array(offsets),
        axes=np.array(axes),
        moments_per_kg=np.array(moments),
        inertias_per_kg=np.array(inertias),
        jaw_mass=float(jaw.get_mass()),
        jaw_moment=float(jaw.get_mass()) * np.asarray(jaw.get_com()),
        jaw_inertia=np.asarray(jaw.CalcRotationalInertia().CopyToFullMatrix3()),
    )
