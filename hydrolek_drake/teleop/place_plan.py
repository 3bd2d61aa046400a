"""Pick and place as a sequence of timed paths: grasp, lift, carry, lower, open, back off (thesis 5.1: other tasks)."""

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RotationMatrix

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.plan import pipe_in_world, thinner
from hydrolek_drake.teleop.steps import CLOSING, OPENING, TaskPlan, timed_step, without_doubles
from hydrolek_drake.vision.camera import CameraModel, direction_to_frame, to_frame
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.targets import PipeTargets
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import ToolPath, grasp_paths, straight_path, with_arm, with_jaw
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries
from hydrolek_drake.workcell.planner import path_is_free, plan_path
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.table import Table, table_under

Array = NDArray[np.float64]

PLACE_STEPS = ("approach", "grasp", CLOSING, "lift", "carry", "lower", OPENING, "back off", "home")
_BACK_OFF = (1.0, 0.9, 0.8, 0.7)  # of the way onto the pipe: as far as the arm can and must, backwards

HOLDING_STEPS = (CLOSING, "lift", "carry", "lower")
"""Steps in which the pipe may be in the gripper."""


@dataclass(frozen=True, kw_only=True)
class PlacePlan(TaskPlan):
    """A planned pick and place.

    Attributes:
        placed: The pipe where it is put down.
        table: What it is taken to stand on.
    """

    placed: Pipe
    table: Table


def plan_place(
    targets: PipeTargets,
    place: ArrayLike,
    camera: CameraModel,
    posture: ArrayLike,
    generator: np.random.Generator,
    *,
    grasping: str = "right",
    on_step: Any = lambda name: None,
) -> PlacePlan:
    """Plan to carry the pipe so that its grasped point comes above a place, and to put it down there as it stands.

    The attitude of the pipe at the place is the one in which it was seen. Its lowest point is brought close above the
    place's height; a pipe whose end was seen about as high as the place is taken to stand on the same surface. What it
    stands on is taken to be level and to reach a while beyond pipe and place.

    Args:
        targets: Of the pipe, in the camera frame; the cut is not used.
        place: Point of a level surface, in the camera frame in m, shape (3,).
        camera: The camera that saw them.
        posture: Both arms as they stand, in rad, shape (14,).
        generator: For the path planner.
        grasping: Arm that grasps, `right` or `left`.
        on_step: Called with each step's name before it is planned.

    Raises:
        InputError: An end of the pipe is not in the picture, a point out of reach, nothing but collisions, no path;
            says which step and why.
    """
    require_both_ends(targets, camera)
    start = np.asarray(posture, dtype=float)
    pipe, sight = with_unseen_ends(pipe_in_world(targets, camera)), direction_to_frame(targets.grasp, "world")
    point, there = to_frame(targets.grasp, "world"), to_frame(np.asarray(place, dtype=float), "world")
    values, sizes = workcell_entries(), kinect_entries("targets")
    stands = pipe.lowest()
    if abs(stands - there[2]) <= values["place"]["unseen_end"]:
        stands = float(there[2])  # on the same surface
    shift = np.array([*(there - point)[:2], there[2] + values["place"]["set_down"] - stands])
    placed = pipe.moved(np.eye(3), shift)
    table = table_under([*_ends(pipe), *_ends(placed)], min(float(there[2]), stands))
    low = table.lowered(values["motion"]["padding"] + 2.0 * values["place"]["unseen_end"])

    on_step("grasp, lift, lower")
    distance = pipe.radius + sizes["approach"] + values["grasp"]["farther"]
    clear = CollisionWorld(pipe, table=table)
    touching = CollisionWorld(thinner(pipe), padding=0.0, table=table)
    gone = CollisionWorld(thinner(placed), padding=0.0, table=low)
    carrying, setting_down = CollisionWorld(None, table=table), CollisionWorld(None, table=low)
    refusal: InputError | None = None
    ways = grasp_paths(point, pipe.axis, sight, distance, start, grasping, clear, touching)
    clear_of_it = CollisionWorld(placed, table=table)
    tries = itertools.product(
        itertools.islice(ways, int(values["place"]["most_grasps"])), values["place"]["lift"]
    )
    for grasp, height in tries:
        try:
            carried = _carried(grasp, height, pipe, shift, start, carrying, setting_down, gone, clear_of_it)
            break
        except InputError as error:
            refusal = refusal or error
    else:
        assert refusal is not None  # else the ways had refused
        raise refusal

    on_step("carry")
    lift, lower = carried.lift, carried.lower
    carry = (
        carried.across if carried.across is not None else plan_path(carrying, lift[-1], lower[0], generator)
    )
    opened = with_jaw(start, grasping, math.radians(values["grasp"]["open_deg"]))
    on_the_way = np.array([with_arm(opened, grasping, row) for row in grasp.angles])
    on_step("approach")
    approach = plan_path(clear, start, on_the_way[0], generator)
    on_step("home")
    home = plan_path(clear_of_it, carried.back[-1], home_posture(), generator)
    paths = {
        "approach": approach,
        "grasp": without_doubles(on_the_way),
        CLOSING: np.array([on_the_way[-1], lift[0]]),
        "lift": without_doubles(lift),
        "carry": without_doubles(carry),
        "lower": without_doubles(lower),
        OPENING: np.array([lower[-1], carried.back[0]]),
        "back off": without_doubles(carried.back),
        "home": home,
    }
    straight = ("grasp", "lift", "lower", "back off", "carry" if carried.across is not None else "")
    steps = [
        timed_step(
            name,
            paths[name],
            grasping if name in HOLDING_STEPS else None,
            line=name in straight,
            least=height / teleop_entries("task")["place_speed"] if name in ("lift", "lower") else 0.0,
        )
        for name in PLACE_STEPS
    ]
    return PlacePlan(tuple(steps), pipe, grasp, None, False, placed=placed, table=table)


@dataclass(frozen=True)
class _Carried:
    """Postures of both arms, each of shape (n, 14), while the pipe is in the hand, and off it.

    Attributes:
        lift: Straight up.
        across: Straight on to above the place; None where that is not possible, or the hand is turned on the way.
        lower: Straight down.
        back: Off the pipe, with the jaw open.
    """

    lift: Array
    across: Array | None
    lower: Array
    back: Array


def _carried(
    grasp: ToolPath,
    height: float,
    pipe: Pipe,
    shift: Array,
    start: Array,
    carrying: CollisionWorld,
    setting_down: CollisionWorld,
    gone: CollisionWorld,
    clear: CollisionWorld,
) -> _Carried:
    """Raises InputError where the arm cannot, for this way onto the pipe, which becomes part of the hand in two worlds.

    At the place the hand may be turned about the pipe's axis, which leaves the pipe's attitude as it is.
    """
    side, values = grasp.side, workcell_entries()
    shut = with_jaw(start, side, math.radians(values["grasp"]["closed_deg"]))
    closed = with_arm(shut, side, grasp.angles[-1])
    for world in (carrying, setting_down):
        world.carry(side, closed, pipe)
    point = grasp.points[-1]
    up = np.array([0.0, 0.0, height])

    def straight(first: Array, last: Array, aim: Array, before: Array, hand: Array = shut) -> Array | None:
        near = before[:6] if side == "right" else before[7:13]
        angles = straight_path(side, first, last, aim, pipe.axis, near)
        return None if angles is None else np.array([with_arm(hand, side, row) for row in angles])

    def checked(name: str, path: Array | None, world: CollisionWorld) -> Array:
        if path is None:
            raise InputError(f"the {side} arm cannot {name}: out of its reach; choose another point")
        if not path_is_free(world, list(path)):
            stuck = next((each for each in path if not world.free(each)), path[0])
            pairs = world.what_touches(stuck)
            raise InputError(f"the {side} arm cannot {name}: {pairs} would touch; choose another point")
        return path

    goal = point + shift
    lift = checked(
        "lift the pipe from where it stands",
        straight(point, point + up, grasp.direction, closed),
        setting_down,
    )
    across: Array | None = straight(point + up, goal + up, grasp.direction, lift[-1])
    if across is not None and not path_is_free(carrying, list(across)):
        across = None
    most, step = values["grasp"]["turn_most_deg"], values["grasp"]["turn_step_deg"]
    refusal: InputError | None = None
    for degrees in sorted(range(-int(most), int(most) + 1, int(step)), key=abs):
        turn = RotationMatrix(AngleAxis(math.radians(degrees), pipe.axis)).matrix()
        aim = turn @ grasp.direction
        before = lift[-1] if across is None or degrees else across[-1]
        try:
            lower = checked("set the pipe down there", straight(goal + up, goal, aim, before), setting_down)
            released = with_jaw(lower[-1], side, math.radians(values["grasp"]["open_deg"]))
            away = turn @ (grasp.points[0] - point)
            ends = (straight(goal, goal + share * away, aim, lower[-1], released) for share in _BACK_OFF)
            far = next((path for path in ends if path is not None and clear.free(path[-1])), None)
            back = checked("back off the pipe there", far, gone)
        except InputError as error:
            refusal = refusal or error
            continue
        return _Carried(lift, None if degrees else across, lower, back)
    assert refusal is not None  # else one of the turns would have been returned
    raise refusal


def plan_place_by_either(
    targets: PipeTargets,
    place: ArrayLike,
    camera: CameraModel,
    posture: ArrayLike,
    generator: np.random.Generator,
    *,
    on_step: Any = lambda name: None,
) -> PlacePlan:
    """`plan_place` by the right arm, or by the left one where the right one cannot.

    Raises:
        InputError: Neither can; says why of both.
    """
    require_both_ends(targets, camera)
    refusals = []
    for side in SIDES:
        try:
            return plan_place(targets, place, camera, posture, generator, grasping=side, on_step=on_step)
        except InputError as error:
            refusals.append(str(error))
    raise InputError("; ".join(refusals))


def with_unseen_ends(pipe: Pipe) -> Pipe:
    """The pipe, longer at both ends by what a camera may miss there."""
    return replace(pipe, length=pipe.length + 2.0 * workcell_entries()["place"]["unseen_end"])


def require_both_ends(targets: PipeTargets, camera: CameraModel) -> None:
    """A pipe is only carried if all of it has been seen.

    Raises:
        InputError: It leaves the picture.
    """
    cylinder, border = targets.cylinder, teleop_entries("task")["border"]
    for sign in (-1.0, 1.0):
        u, v = camera.pixel(cylinder.point + sign * cylinder.half_length * cylinder.axis)
        if min(u, v, camera.width - 1 - u, camera.height - 1 - v) < border:
            raise InputError(
                "the pipe leaves the picture; only a pipe with both ends in view is carried, such as a loose one"
            )


def _ends(pipe: Pipe) -> list[Array]:
    return [pipe.point + sign * 0.5 * pipe.length * pipe.axis for sign in (-1.0, 1.0)]
