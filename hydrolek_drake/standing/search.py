"""Search for places from which one arm can grasp a pipe and the other cut it, and how good each of them is."""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, arm_chain
from hydrolek_drake.standing.answer import Answer, MapPoint, Margins, Standing
from hydrolek_drake.standing.base import Base, Placement
from hydrolek_drake.standing.clearance import BaseClearance
from hydrolek_drake.standing.grid import places_before
from hydrolek_drake.standing.reach import ReachMap, Stage, why_not
from hydrolek_drake.standing.site import FLOOR, Site
from hydrolek_drake.teleop.plan import TaskWorlds, ToolPaths, camera_in_world, plan_grasp_and_cut, tool_paths
from hydrolek_drake.teleop.steps import TaskPlan
from hydrolek_drake.workcell.grasp import ToolPath, with_arm
from hydrolek_drake.workcell.scene import home_posture

Array = NDArray[np.float64]

EITHER = "either"
_LOOK = 4.0  # of the wanted clearance: nothing farther is looked for
_MOST_BUILT = 12  # worlds of collisions kept
_TOLD = 8  # times that the progress of a map is told
_SAMPLES = 25  # of each step of a plan, for its margin


@dataclass(frozen=True)
class _Looked:
    placement: Placement
    grasping: str
    margins: Margins


class StandingSearch:
    """Places for one site.

    Args:
        site: Pipe and what stands around.
        base: Ranges of tracks and boom.
        grasping: `right`, `left`, or `either`.
        generator: For the path planner.
        tell: Told what is done next.

    Raises:
        InputError: There is no such arm.
    """

    def __init__(
        self,
        site: Site,
        base: Base,
        *,
        generator: np.random.Generator,
        grasping: str = EITHER,
        tell: Callable[[str], None] = lambda text: None,
    ) -> None:
        if grasping not in (*SIDES, EITHER):
            raise InputError(f"arm '{grasping}' is unknown; choose from {', '.join((*SIDES, EITHER))}")
        self._site, self._base, self._generator, self._tell = site, base, generator, tell
        self._sides = SIDES if grasping == EITHER else (grasping,)
        self._reach, self._base_clearance = ReachMap(site), BaseClearance(site)
        self._built: dict[tuple[float, str], TaskWorlds] = {}
        self._refusals: Counter[str] = Counter()

    def answer(self, count: int = 3) -> Answer:
        """The best places, checked by planning the whole task from each.

        Args:
            count: How many are wanted.
        """
        settings = self._base.search
        points = self.coarse_map()
        reached = [point for point in points if point.stage is Stage.REACHED]
        reached = self._in_turn(reached)
        self._tell(
            f"{len(points)} places: {len(reached)} by kinematics"
            + ("; checking collisions" if reached else "")
        )
        looked: list[_Looked] = []
        for index, point in enumerate(reached[: int(settings["looked_at"])]):
            found = self._look(point.placement, point.grasping)
            if found is not None:
                looked.append(found)
            if index % 20 == 19:
                self._tell(f"checked {index + 1} places, {len(looked)} free")
        if not looked:
            return Answer((), points, self._why_none(points, reached))
        looked.sort(key=lambda each: -each.margins.score)
        refined: list[_Looked] = []
        for each in looked[: int(settings["refined"])]:
            self._tell(f"refining {len(refined) + 1}: margin {each.margins.score:.2f} of what is wanted")
            refined.append(self._refined(each))
        return self._planned(sorted([*refined, *looked], key=lambda each: -each.margins.score), count, points)

    def coarse_map(self) -> tuple[MapPoint, ...]:
        """All places of the grid within the ranges, each with what kinematics and the base's shape say of it."""
        points: list[MapPoint] = []
        grid = list(places_before(self._site, self._base))
        for index, placement in enumerate(grid):
            if index % max(1, len(grid) // _TOLD) == 0 and index:
                self._tell(f"kinematics: {index} of {len(grid)} places")
            points += [self.point(placement, side) for side in self._sides]
        return tuple(points)

    def look(self, placement: Placement, grasping: str) -> tuple[Margins, ToolPaths]:
        """How the tools' ways from a placement are, by the planner that teleoperation uses.

        Raises:
            InputError: A point out of reach, or something would touch; says what.
        """
        base, what = self._base_clearance.of(placement, _LOOK * max(self._base.keep, self._base.clearance))
        if base < self._base.keep:
            raise InputError(f"base or boom would be {1e3 * base:.0f} mm from {what}")
        worlds = self._worlds(placement, grasping)
        ways = tool_paths(worlds, *self._points_seen(placement), home_posture())
        joint, name = min(_joint_margin(each) for each in (ways.grasp, ways.cut))
        within = _LOOK * self._base.clearance
        opened = home_posture()
        postures = [with_arm(opened, grasping, row) for row in ways.grasp.angles]
        postures += [with_arm(ways.closed, ways.cut.side, row) for row in ways.cut.angles]
        clearance = min(worlds.held.clearance(each, within) for each in postures)
        score = min(joint / self._base.joint_margin, clearance / self._base.clearance)
        return Margins(joint, name, clearance, base, score), ways

    def plan(self, placement: Placement, grasping: str) -> TaskPlan:
        """The whole task from a placement.

        Raises:
            InputError: It cannot be planned; says which step and why.
        """
        return plan_grasp_and_cut(
            self._worlds(placement, grasping),
            *self._points_seen(placement),
            home_posture(),
            self._generator,
        )

    def _worlds(self, placement: Placement, grasping: str) -> TaskWorlds:
        """Pipe, blocks and floor as the machine has them there; those of one height are moved, not built anew."""
        pipe = placement.pipe_seen(self._site.pipe)
        around = placement.surroundings((*self._site.blocks, FLOOR))
        key = (placement.boom, grasping)
        if key in self._built:
            self._built[key].put(pipe, around.blocks)
        else:
            if len(self._built) >= _MOST_BUILT:
                self._built.pop(next(iter(self._built)))
            self._built[key] = TaskWorlds(pipe, grasping, around)
        return self._built[key]

    def _points_seen(self, placement: Placement) -> tuple[Array, Array, Array]:
        grasp, cut = (
            placement.point_seen(each) for each in (self._site.grasp_point(), self._site.cut_point())
        )
        return grasp, cut, grasp - camera_in_world()

    def point(self, placement: Placement, side: str) -> MapPoint:
        """What kinematics and the base's shape say of one placement."""
        reach = self._reach.of(placement, side)
        stage = reach.stage
        if (
            stage is Stage.REACHED
            and self._base_clearance.of(placement, self._base.keep)[0] < self._base.keep
        ):
            stage = Stage.BASE
        return MapPoint(placement, side, stage, reach.margin if stage is Stage.REACHED else 0.0)

    def _in_turn(self, points: list[MapPoint]) -> list[MapPoint]:
        """One of each that the arms see alike, by the shortest way of the tracks, before a second one of any."""
        alike: dict[tuple[float, ...], list[MapPoint]] = {}
        for point in sorted(points, key=lambda each: (_way(each.placement), each.grasping == "left")):
            key = self._reach.key(point.placement, point.grasping)
            alike.setdefault(key, []).append(point)
        turns = [(turn, point) for group in alike.values() for turn, point in enumerate(group)]
        turns.sort(key=lambda each: (each[0], -round(each[1].margin, 3), _way(each[1].placement)))
        return [point for _, point in turns]

    def _look(self, placement: Placement, grasping: str) -> _Looked | None:
        try:
            return _Looked(placement, grasping, self.look(placement, grasping)[0])
        except InputError as error:
            self._refusals[str(error)] += 1
            return None

    def _refined(self, best: _Looked) -> _Looked:
        """Pattern search: one of x, y, heading, boom by a step to either side, the steps halved when none is better."""
        settings = self._base.search
        steps = {
            "x": settings["distance_step"],
            "y": settings["distance_step"],
            "heading": settings["heading_step"],
            "boom": settings["boom_step"],
        }
        for _ in range(int(settings["rounds"])):
            steps = {name: 0.5 * step for name, step in steps.items()}
            for name, step in steps.items():
                for sign in (-1.0, 1.0):
                    nearby = replace(best.placement, **{name: getattr(best.placement, name) + sign * step})
                    if not self._base.allows(nearby):
                        continue
                    if self.point(nearby, best.grasping).stage is not Stage.REACHED:
                        continue
                    found = self._look(nearby, best.grasping)
                    if found is not None and found.margins.score > best.margins.score:
                        best = found
                        break
        return best

    def _planned(self, looked: list[_Looked], count: int, points: tuple[MapPoint, ...]) -> Answer:
        standings: list[Standing] = []
        refusal = ""
        for each in looked:
            if len(standings) >= count:
                break
            if any(
                _apart(each.placement, other.placement) < self._base.search["apart"] for other in standings
            ):
                continue
            self._tell(f"planning the task from place {len(standings) + 1}")
            try:
                plan = self.plan(each.placement, each.grasping)
            except InputError as error:
                refusal = refusal or str(error)
                continue
            standings.append(Standing(each.placement, each.grasping, each.margins, plan, _plan_margin(plan)))
        reason = "" if standings else f"{Stage.PATH.told()}: {refusal}"
        return Answer(tuple(standings), points, reason)

    def _why_none(self, points: tuple[MapPoint, ...], reached: list[MapPoint]) -> str:
        if not points:
            return "no place within the ranges of tracks and boom has the pipe before the arms; widen them"
        if reached:
            said, times = self._refusals.most_common(1)[0]
            looked = sum(self._refusals.values())
            return (
                f"{len(reached)} of {len(points)} places would do by kinematics, but at the {looked} "
                f"best of them something would touch or stop short; most often ({times}): {said}"
            )
        count = Counter(point.stage for point in points)
        last = max(count)
        nearest = min(
            (point for point in points if point.stage is last),
            key=lambda point: (_way(point.placement), point.grasping),
        )
        told = "; ".join(f"{stage.told()} ({count[stage]})" for stage in sorted(count))
        why = (
            ""
            if last in (Stage.VIEW, Stage.BASE)
            else why_not(self._site, nearest.placement, nearest.grasping)
        )
        return f"of {len(points)} places none will do: {told}" + (f"; such as: {why}" if why else "")


def _joint_margin(path: ToolPath) -> tuple[float, str]:
    chain = arm_chain(path.side)
    room = np.minimum(path.angles[:, :5] - chain.lower[:5], chain.upper[:5] - path.angles[:, :5])
    joint = int(room.min(axis=0).argmin())
    return float(room.min()), f"{path.side}_j{joint + 1}"


def _plan_margin(plan: TaskPlan) -> float:
    least = math.inf
    for step in plan.steps:
        for time in np.linspace(0.0, step.trajectory.end_time(), _SAMPLES):
            posture = step.trajectory.value(time)[:, 0]
            for index, side in enumerate(SIDES):
                angles, chain = posture[7 * index : 7 * index + 5], arm_chain(side)
                least = min(
                    least, float(np.min(np.minimum(angles - chain.lower[:5], chain.upper[:5] - angles)))
                )
    return least


def _way(placement: Placement) -> float:
    """How far the tracks go from where the machine stands now, a turn counted as the way of the arms' tools."""
    turn = (placement.heading + math.pi) % math.tau - math.pi
    return round(math.hypot(placement.x, placement.y) + abs(turn) + abs(placement.plate_shift()[1]), 6)


def _apart(one: Placement, other: Placement) -> float:
    return math.hypot(one.x - other.x, one.y - other.y, one.plate_shift()[1] - other.plate_shift()[1])
