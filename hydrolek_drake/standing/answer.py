"""What a search for places found: the places, how good each is, and the coarse map around them."""

from dataclasses import dataclass

from hydrolek_drake.standing.base import Placement
from hydrolek_drake.standing.reach import Stage
from hydrolek_drake.teleop.steps import TaskPlan


@dataclass(frozen=True)
class MapPoint:
    """One place of the coarse map.

    Attributes:
        placement: Where.
        grasping: Arm that grasps.
        stage: How far kinematics and base come.
        margin: Smallest joint margin in rad at the points that were solved for; 0 where not reached.
    """

    placement: Placement
    grasping: str
    stage: Stage
    margin: float


@dataclass(frozen=True)
class Margins:
    """How far a placement is from what would end it.

    Attributes:
        joint: Smallest angle in rad between a joint and its stop, while the tools work.
        joint_name: Whose.
        clearance: Smallest distance in m between an arm and anything else while the tools work.
        base: Of base and boom from everything, in m.
        score: Smaller of both shares: `joint` and `clearance` of what is wanted of them; 1 has all that is wanted.
    """

    joint: float
    joint_name: str
    clearance: float
    base: float
    score: float


@dataclass(frozen=True)
class Standing:
    """A placement from which the task is planned.

    Attributes:
        placement: Where.
        grasping: Arm that grasps.
        margins: While the tools work.
        plan: The whole task, in the arms' world frame there.
        plan_margin: Smallest angle in rad between a joint and its stop all along the plan.
    """

    placement: Placement
    grasping: str
    margins: Margins
    plan: TaskPlan
    plan_margin: float


@dataclass(frozen=True)
class Answer:
    """What a search found.

    Attributes:
        standings: Best first; empty where there is none.
        points: The coarse map.
        reason: Why there is none; empty if there is one.
    """

    standings: tuple[Standing, ...]
    points: tuple[MapPoint, ...]
    reason: str = ""
