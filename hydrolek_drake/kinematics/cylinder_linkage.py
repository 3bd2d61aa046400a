"""Linear cylinders between two links: where they are fixed, how long they are, what lever arm they have."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.kinematics.forward import arm_geometry
from hydrolek_drake.units import si_factor
from hydrolek_drake.yaml_files import package_yaml

Array = NDArray[np.float64]

_SI_UNITS = {
    "a": "m",
    "b": "m",
    "phi": "rad",
    "mount_angle": "rad",
    "axial_offset": "m",
    "bore": "m",
    "rod": "m",
    "barrel": "m",
}


@dataclass(frozen=True)
class CylinderLinkage:
    """The triangle of joint axis, mount on the parent link and mount on the child link.

    Attributes:
        axis: Coordinate axis that the joint turns about: 0 for X, 1 for Y, 2 for Z.
        a: Distance of the parent mount from the joint axis, in m.
        b: Distance of the child mount from the joint axis, in m.
        phi: Included angle at joint angle 0, in rad.
        mount_angle: Direction of the parent mount about the axis, in rad, from e1 towards e2, where
            (e1, e2, axis) are right-handed coordinate axes: for Z (X, Y), for Y (Z, X), for X (Y, Z).
        direction: 1 if the rod's extension moves the joint positive, -1 if negative.
        axial_offset: Distance of the cylinder's plane from the joint's origin along the axis, in m.
        bore: Diameter of the piston, in m.
        rod: Diameter of the rod, in m.
        barrel: Outer diameter of the barrel, in m; for pictures.
    """

    axis: int
    a: float
    b: float
    phi: float
    mount_angle: float
    direction: int
    axial_offset: float
    bore: float
    rod: float
    barrel: float

    def included_angle(self, angle: ArrayLike) -> Array:
        """Angle between both mounts seen from the joint axis, direction * q + phi, in rad."""
        return self.direction * np.asarray(angle, dtype=float) + self.phi

    def length(self, angle: ArrayLike) -> Array:
        """Distance between both mounts in m: L^2 = a^2 + b^2 - 2 a b cos(direction * q + phi)."""
        return np.sqrt(self.a**2 + self.b**2 - 2 * self.a * self.b * np.cos(self.included_angle(angle)))

    def lever_arm(self, angle: ArrayLike) -> Array:
        """Joint torque per force that pushes the mounts apart, dL/dq, in m, with the direction's sign."""
        return self.direction * self.a * self.b * np.sin(self.included_angle(angle)) / self.length(angle)

    def parent_point(self) -> Array:
        """Parent mount in the joint frame that is fixed to the parent link, in m, shape (3,)."""
        return self._point(self.a, self.mount_angle)

    def child_point(self) -> Array:
        """Child mount in the joint frame that is fixed to the child link, in m, shape (3,)."""
        return self._point(self.b, self.mount_angle + self.direction * self.phi)

    def piston_area(self) -> float:
        """Area that the pressure acts on when it extends the rod, in m^2."""
        return np.pi / 4 * self.bore**2

    def annulus_area(self) -> float:
        """Area that the pressure acts on when it retracts the rod, in m^2."""
        return np.pi / 4 * (self.bore**2 - self.rod**2)

    def mirrored(self) -> "CylinderLinkage":
        """The same cylinder on the other arm, mirrored about the arm base frame's plane z = 0."""
        if self.axis == 2:
            return replace(self, axial_offset=-self.axial_offset)
        # z is the first in-plane direction for axis Y, the second for axis X
        mirrored_angle = np.pi - self.mount_angle if self.axis == 1 else -self.mount_angle
        return replace(self, mount_angle=mirrored_angle, direction=-self.direction)

    def _point(self, distance: float, angle: float) -> Array:
        point = np.zeros(3)
        point[self.axis] = self.axial_offset
        point[(self.axis + 1) % 3] = distance * np.cos(angle)
        point[(self.axis + 2) % 3] = distance * np.sin(angle)
        return point


@cache
def cylinder_linkages() -> dict[str, CylinderLinkage]:
    """The cylinders of both arms by joint name (`right_j1`, ...), from `cylinder_mounts.yaml`, in SI units.

    Joints 4 (vane) and 6 (motor) have no linear cylinder.
    """
    data = package_yaml(__package__, "cylinder_mounts.yaml")
    geometry = arm_geometry()
    axes = {
        f"j{number}": axis for number, axis in enumerate((*geometry.axes, geometry.gripper_axis), start=1)
    }
    right, left = {}, {}
    for joint, entries in data.items():
        values = {
            name: float(entries[name]["value"]) * si_factor(entries[name]["unit"], unit)
            for name, unit in _SI_UNITS.items()
        }
        linkage = CylinderLinkage(axis=axes[joint], direction=int(entries["direction"]["value"]), **values)
        right[f"right_{joint}"] = linkage
        left[f"left_{joint}"] = linkage.mirrored()
    return right | left
