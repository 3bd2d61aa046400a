"""Where the operator is in a task, and which steps the arms then take."""

from enum import Enum

from hydrolek_drake.teleop.place_plan import PLACE_STEPS
from hydrolek_drake.teleop.plan import STEPS
from hydrolek_drake.teleop.target_selection.clicks import Task, Wanted


class Stage(Enum):
    """Where the operator is; each but the first and the last three waits for one click."""

    LIVE = "Take a snapshot when the pipe is in view."
    OBJECT = "Click the pipe, in either picture."
    GRASP = "Click where to grasp it."
    CUT = "Click where to cut it."
    PLACE = "Click where to put it down, on the table."
    CONFIRM = "Check the marks, then confirm."
    PLANNING = "Planning the motion."
    MOVING = "The arms are moving."


STAGE_FOR = {
    Wanted.OBJECT: Stage.OBJECT,
    Wanted.GRASP: Stage.GRASP,
    Wanted.CUT: Stage.CUT,
    Wanted.PLACE: Stage.PLACE,
    Wanted.NOTHING: Stage.CONFIRM,
}
STEPS_OF = {Task.CUT: STEPS, Task.PLACE: PLACE_STEPS}
