"""Distance of the machine's base, boom and plate from pipe and blocks of a site."""

from functools import cache
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Box, Cylinder
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.multibody.tree import SpatialInertia, default_model_instance
from pydrake.systems.framework import DiagramBuilder

from hydrolek_drake.standing.base import Placement, drawn_boom_angle
from hydrolek_drake.standing.site import Site
from hydrolek_drake.workcell.surroundings import Surroundings

Array = NDArray[np.float64]

_LINKS = ("brokk_base", "plate")


class BaseClearance:
    """The base's shapes from the URDF among those of a site.

    Args:
        site: Pipe and blocks.
    """

    def __init__(self, site: Site) -> None:
        builder = DiagramBuilder()
        self._plant, self._scene = AddMultibodyPlantSceneGraph(builder, 0.0)
        plant, friction = self._plant, CoulombFriction()
        self._boxes = []
        for index, (_, size) in enumerate(base_boxes(drawn_boom_angle())):
            body = plant.AddRigidBody(
                f"machine{index}",
                default_model_instance(),
                SpatialInertia.SolidBoxWithMass(1.0, 1.0, 1.0, 1.0),
            )
            plant.RegisterCollisionGeometry(body, RigidTransform(), Box(*size), f"machine{index}", friction)
            self._boxes.append(body)
        pipe = site.pipe
        place = RigidTransform(RotationMatrix(pipe.rotation()), pipe.point)
        plant.RegisterCollisionGeometry(
            plant.world_body(), place, Cylinder(pipe.radius, pipe.length), "pipe", friction
        )
        for block in site.blocks:
            plant.RegisterCollisionGeometry(
                plant.world_body(), block.pose(), Box(*block.size), block.name, friction
            )
        plant.Finalize()
        self._diagram = builder.Build()
        self._context = self._diagram.CreateDefaultContext()

    def of(self, placement: Placement, within: float) -> tuple[float, str]:
        """Smallest distance in m, and what is so near; at most `within`, and then nothing is named."""
        turn, _ = placement.machine_in_site()
        base = RigidTransform(RotationMatrix(turn), [placement.x, placement.y, 0.0])
        own = self._plant.GetMyMutableContextFromRoot(self._context)
        for body, (pose, _) in zip(self._boxes, base_boxes(placement.boom), strict=True):
            self._plant.SetFreeBodyPose(own, body, base @ pose)
        port: Any = self._scene.get_query_output_port()
        query = port.Eval(self._scene.GetMyContextFromRoot(self._context))
        inspector, least, what = query.inspector(), within, ""
        world = self._plant.GetBodyFrameIdOrThrow(self._plant.world_body().index())
        for pair in query.ComputeSignedDistancePairwiseClosestPoints(within):
            names = [each for each in (pair.id_A, pair.id_B) if inspector.GetFrameId(each) == world]
            if len(names) == 1 and pair.distance < least:
                least, what = float(pair.distance), str(inspector.GetName(names[0])).rpartition("::")[2]
        return least, what


@cache
def base_boxes(boom: float) -> list[tuple[RigidTransform, Array]]:
    """Pose in the base's frame and size of each collision box of base, boom and plate."""
    shift = Placement(0.0, 0.0, 0.0, boom).plate_shift()
    robot = ElementTree.fromstring(Surroundings((), shift, boom - drawn_boom_angle()).urdf())
    plate = next(joint for joint in robot.iter("joint") if joint.get("name") == "plate_weld").find("origin")
    assert plate is not None
    found = []
    for link in robot.iter("link"):
        if link.get("name") not in _LINKS:
            continue
        start = RigidTransform() if link.get("name") == _LINKS[0] else _pose(plate)
        for collision in link.iter("collision"):
            origin, box = collision.find("origin"), collision.find("geometry/box")
            assert origin is not None and box is not None
            found.append((start @ _pose(origin), _numbers(box.get("size", ""))))
    return found


def _pose(origin: ElementTree.Element) -> RigidTransform:
    turned: Any = _numbers(origin.get("rpy", "0 0 0"))
    return RigidTransform(RollPitchYaw(turned), _numbers(origin.get("xyz", "0 0 0")))


def _numbers(text: str) -> Array:
    return np.array([float(word) for word in text.split()])
