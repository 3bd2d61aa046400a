"""Whether the arms touch each other, their base or the pipe: Drake's collision checker on the arms' shapes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.geometry import Box, Cylinder
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction
from pydrake.multibody.tree import SpatialInertia, default_model_instance
from pydrake.planning import RobotDiagramBuilder, SceneGraphCollisionChecker

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import arm_joint_names, arms_urdf_path, position_indices
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries
from hydrolek_drake.workcell.surroundings import Block, Surroundings
from hydrolek_drake.workcell.table import Table

_NAMED = 2
"""Pairs of bodies that a message names."""
_BASE = "base"
_HAND = ("link6", "jaw")
"""How the names of a hand's bodies end."""
_WORLD = "world"
"""Drake's name for what pipe and table are fixed to."""


class CollisionWorld:
    """Arms, base and pipe; postures are joints `right_j1` ... `left_j7` in rad, shape (14,).

    Args:
        pipe: The pipe, or None for none.
        padding: Distance in m within which two shapes count as touching.
        holding: Sides (`right`, `left`) whose gripper may touch the pipe.
        table: What stands below, or None.
        around: What else stands around, and where the base is under the plate.
    """

    def __init__(
        self,
        pipe: Pipe | None,
        *,
        padding: float | None = None,
        holding: tuple[str, ...] = (),
        table: Table | None = None,
        around: Surroundings | None = None,
    ) -> None:
        around = Surroundings() if around is None else around
        values = workcell_entries()["motion"]
        stands = [name for name, thing in (("pipe", pipe), ("table", table)) if thing is not None]
        self._surroundings = " or ".join(stands)
        self.padding = float(values["padding"] if padding is None else padding)
        builder = RobotDiagramBuilder(time_step=0.0)
        parser = builder.parser()
        parser.package_map().AddPackageXml(str(arms_urdf_path().parent / "package.xml"))
        instances = parser.AddModelsFromString(around.urdf(), "urdf")
        plant = builder.plant()
        for block in around.blocks:  # each a body of its own, which messages call by its name
            body = plant.AddRigidBody(block.name, default_model_instance(), SpatialInertia.Zero())
            plant.WeldFrames(plant.world_frame(), body.body_frame())
        if table is not None:
            pose = RigidTransform(table.top - [0.0, 0.0, 0.5 * table.thickness])
            board = Box(*table.size, table.thickness)
            plant.RegisterCollisionGeometry(plant.world_body(), pose, board, "table", CoulombFriction())
        plant.Finalize()
        self._machine = set(instances)
        self._order = position_indices(plant, list(arm_joint_names()))
        model = builder.Build()
        self._checker = SceneGraphCollisionChecker(
            model=model,
            robot_model_instances=instances,
            edge_step_size=float(values["edge_step"]),
            env_collision_padding=self.padding,
            self_collision_padding=self.padding,
            configuration_distance_function=lambda a, b: float(np.linalg.norm(a - b)),
        )
        self.put(pipe, around.blocks)
        for side in holding:
            for link in ("link6", "jaw"):
                self._checker.SetCollisionFilteredBetween(
                    plant.GetBodyByName(f"{side}_{link}"), plant.world_body(), True
                )
        # Base and link 2, link 3 and link 5 of one arm: the drawn boxes overlap within the joint's travel, whose end
        # stops keep the real ones apart.
        for side in SIDES:
            for pair in (("base", "link2"), ("link3", "link5")):
                self._checker.SetCollisionFilteredBetween(
                    *(plant.GetBodyByName(f"{side}_{link}") for link in pair), True
                )

    def put(self, pipe: Pipe | None, blocks: Sequence[Block]) -> None:
        """Put pipe and blocks elsewhere, as where the machine has moved and they have not.

        Args:
            pipe: In place of the one before, or None for none.
            blocks: In place of those before, of the same names.
        """
        self._checker.RemoveAllAddedCollisionShapes("surroundings")
        plant, shapes = self._checker.plant(), []
        if pipe is not None:
            pose = RigidTransform(RotationMatrix(pipe.rotation()), pipe.point)
            shapes.append((plant.world_body(), Cylinder(pipe.radius, pipe.length), pose))
        shapes += [(plant.GetBodyByName(each.name), Box(*each.size), each.pose()) for each in blocks]
        for body, shape, pose in shapes:
            if not self._checker.AddCollisionShapeToBody("surroundings", body, shape, pose):
                raise InputError(f"{body.name()} cannot be put among the arms")

    def carry(self, side: str, posture: Any, pipe: Pipe) -> None:
        """From now on a pipe is part of a hand, in place of one before; hand, jaw and the link next to it may touch it.

        Args:
            side: `right` or `left`.
            posture: In which the hand holds the pipe.
            pipe: Where the pipe is then.
        """
        plant = self._checker.plant()
        context = plant.CreateDefaultContext()
        plant.SetPositions(context, self._positions(posture))
        hand = plant.GetBodyByName(f"{side}_link6")
        place = RigidTransform(RotationMatrix(pipe.rotation()), pipe.point)
        in_hand = plant.EvalBodyPoseInWorld(context, hand).inverse() @ place
        shape = Cylinder(pipe.radius, pipe.length)
        self._checker.RemoveAllAddedCollisionShapes("carried")
        if not self._checker.AddCollisionShapeToBody("carried", hand, shape, in_hand):
            raise InputError("the pipe cannot be made part of the hand")

    def free(self, posture: Any) -> bool:
        """Whether nothing touches."""
        return bool(self._checker.CheckConfigCollisionFree(self._positions(posture)))

    def free_between(self, first: Any, second: Any) -> bool:
        """Whether nothing touches on the straight way in joint space; checked every `edge_step` rad."""
        first, second = self._positions(first), self._positions(second)
        return bool(self._checker.CheckEdgeCollisionFree(first, second))

    def touching(self, posture: Any) -> list[tuple[str, str]]:
        """Names of the bodies that touch, in pairs; what stands around the arms is `pipe`, `table`, `pipe or table`."""
        positions = self._positions(posture)
        clearance = self._checker.CalcRobotClearance(positions, self.padding)
        plant, pairs = self._checker.plant(), set()
        for row in range(clearance.size()):
            if clearance.distances()[row] < self.padding:
                indices = (clearance.robot_indices()[row], clearance.other_indices()[row])
                one, other = sorted(self._called(plant.get_body(index)) for index in indices)
                pairs.add((one, other))
        return sorted(pairs)

    def clearance(self, posture: Any, within: float) -> float:
        """Smallest distance in m between an arm and what is neither that arm nor the machine's base.

        Hands work at the pipe, and their distance from it is no clearance; that of the links behind them is.

        Args:
            posture: Of both arms.
            within: Distance in m beyond which nothing is looked for; the answer is at most this.
        """
        found = self._checker.CalcRobotClearance(self._positions(posture), within)
        plant, least = self._checker.plant(), within
        for row in range(found.size()):
            pair = [plant.get_body(each[row]) for each in (found.robot_indices(), found.other_indices())]
            one, other = (self._part(body) for body in pair)
            names = [str(body.name()) for body in pair]
            if _WORLD in names and any(name.endswith(_HAND) for name in names):
                continue
            inside = one is not None and other is not None  # the machine
            if not (inside and (one == other or _BASE in (one, other))):
                least = min(least, float(found.distances()[row]))
        return least

    def _part(self, body: Any) -> str | None:
        """Part of the machine that a body belongs to: an arm, or the base; None for what stands around."""
        if body.model_instance() not in self._machine:
            return None
        side = str(body.name()).partition("_")[0]
        return side if side in SIDES else _BASE

    def what_touches(self, posture: Any) -> str:
        """The first of the bodies that touch, for a message."""
        pairs = [f"{first} and {second}" for first, second in self.touching(posture)]
        more = len(pairs) - _NAMED
        return ", ".join(pairs[:_NAMED]) + (f" and {more} other pairs" if more > 0 else "")

    def _called(self, body: Any) -> str:
        return self._surroundings if body.name() == _WORLD else str(body.name())

    def _positions(self, posture: Any) -> Any:
        posture = np.asarray(posture, dtype=float)
        if posture.shape != (len(self._order),) or not np.isfinite(posture).all():
            raise InputError(
                f"posture has shape {posture.shape}; give {len(self._order)} finite angles in rad"
            )
        positions = np.zeros(len(self._order))
        positions[self._order] = posture
        return positions
