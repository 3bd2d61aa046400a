"""What stands around the machine besides pipe and table, and where its base is under the shoulder plate."""

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from pydrake.math import RigidTransform

Array = NDArray[np.float64]

_BASE_WELD, _PLATE_WELD, _BASE, _BOOM = "brokk_base_weld", "plate_weld", "brokk_base", "boom"


@dataclass(frozen=True)
class Block:
    """An upright box that nothing may touch.

    Attributes:
        name: For messages.
        middle: In m, shape (3,).
        size: Edge lengths in m, shape (3,).
        heading: Angle in rad by which it is turned about the vertical.
    """

    name: str
    middle: Array
    size: Array
    heading: float = 0.0

    def pose(self) -> "RigidTransform":
        """Of its middle."""
        from pydrake.math import (
            RigidTransform,
            RollPitchYaw,
        )  # takes a while to load, which bad input need not wait for

        return RigidTransform(RollPitchYaw(0.0, 0.0, self.heading), self.middle)

    def moved(self, heading: float, translation: ArrayLike) -> "Block":
        """Turned about the origin's vertical axis and then shifted by a vector (3,)."""
        c, s = math.cos(heading), math.sin(heading)
        x, y, z = self.middle
        turned = np.array([c * x - s * y, s * x + c * y, z])
        return replace(
            self, middle=turned + np.asarray(translation, dtype=float), heading=self.heading + heading
        )


@dataclass(frozen=True)
class Surroundings:
    """Blocks around the machine, in the world frame of the arms' kinematics, and the base's place in it.

    That frame moves with the shoulder plate, so that arms and camera keep their places in it when the boom lifts the
    plate; what moves then is the base.

    Attributes:
        blocks: What stands around.
        plate_shift: How far forward and up the boom has brought the plate from where the URDF draws it, in m.
        boom_turn: Angle in rad by which the boom has turned for that, positive up.
    """

    blocks: tuple[Block, ...] = ()
    plate_shift: tuple[float, float] = (0.0, 0.0)
    boom_turn: float = 0.0

    def urdf(self) -> str:
        """Text of the arms' URDF with base and boom in their places."""
        from pydrake.math import RigidTransform, RollPitchYaw

        from hydrolek_drake.kinematics.arms import arms_urdf_path

        text = arms_urdf_path().read_text(encoding="utf-8")
        if self.plate_shift == (0.0, 0.0) and self.boom_turn == 0.0:
            return text
        robot = ElementTree.fromstring(text)
        forward, up = self.plate_shift
        for name, sign in ((_BASE_WELD, -1.0), (_PLATE_WELD, 1.0)):
            joint = next(each for each in robot.iter("joint") if each.get("name") == name)
            origin = joint.find("origin")
            if origin is None:
                origin = ElementTree.SubElement(joint, "origin")
            before = _numbers(origin.get("xyz", "0 0 0"))
            origin.set("xyz", _text(before + sign * np.array([forward, 0.0, up])))
        base = next(each for each in robot.iter("link") if each.get("name") == _BASE)
        pivot = boom_pins()[0]
        turn = RigidTransform(RollPitchYaw(0.0, -self.boom_turn, 0.0), np.zeros(3))
        for shape in (*base.iter("visual"), *base.iter("collision")):
            origin = shape.find("origin")
            if not shape.get("name", "").startswith(_BOOM) or origin is None:
                continue
            place = RigidTransform(
                RollPitchYaw(_numbers(origin.get("rpy", "0 0 0"))), _numbers(origin.get("xyz", "0 0 0"))
            )
            place = RigidTransform(pivot) @ turn @ RigidTransform(-pivot) @ place
            origin.set("xyz", _text(place.translation()))
            origin.set("rpy", _text(place.rotation().ToRollPitchYaw().vector()))
        return ElementTree.tostring(robot, encoding="unicode")


@cache
def boom_pins() -> tuple[Array, Array]:
    """Where the URDF draws the boom's pivot on the base and its pin at the plate, world frame, in m, each (3,)."""
    from hydrolek_drake.kinematics.arms import arms_urdf_path

    robot = ElementTree.parse(arms_urdf_path()).getroot()
    found = {}
    for shape in robot.iter("visual"):
        origin = shape.find("origin")
        if origin is not None and shape.get("name") in ("boom_pivot", "boom_pin"):
            found[shape.get("name")] = _numbers(origin.get("xyz", "0 0 0"))
    if len(found) != 2:
        raise InputError("hydrolek.urdf: the visuals boom_pivot and boom_pin are missing")
    for point in found.values():
        point.flags.writeable = False  # shared by all callers through the cache
    return found["boom_pivot"], found["boom_pin"]


def _numbers(text: str) -> Array:
    return np.array([float(word) for word in text.split()])


def _text(values: ArrayLike) -> str:
    return " ".join(f"{value:.17g}" for value in np.asarray(values, dtype=float))
