"""What the operator selects in a snapshot: the task, the sliders of the edge picture, and the clicks into it."""

from dataclasses import replace
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.target_selection.clicks import Clicks, Task
from hydrolek_drake.teleop.target_selection.pictures import Pictures
from hydrolek_drake.vision.edges import EdgeSettings, default_settings
from hydrolek_drake.vision.frames import Frame
from hydrolek_drake.vision.selection import Fill

SLIDERS = ("low_contrast", "high_contrast", "sensitivity")
"""Names of the edge picture's settings, each between 0 and 1."""


def task_named(name: str) -> Task:
    """The task of this name.

    Raises:
        InputError: Unknown name.
    """
    if name not in [task.value for task in Task]:
        raise InputError(f"task '{name[:40]}' is unknown; choose from cut, place")
    return Task(name)


class TargetSelection:
    """Object, grasp, and cut or place, from one snapshot after the other. Not for several threads at a time.

    Task, sliders and fill outlast a snapshot, the clicks do not.

    Args:
        pictures: Where `colour` and `edges` are shown.

    Attributes:
        task: What the clicks are for.
        settings: Of the edge picture, as the sliders stand.
        clicks: Into the present snapshot; None if there is none.
    """

    def __init__(self, pictures: Pictures) -> None:
        self._pictures = pictures
        self._fill = Fill.SURFACES
        self.task = Task.CUT
        self.settings: EdgeSettings = default_settings()
        self.clicks: Clicks | None = None

    def begin(self, frame: Frame) -> None:
        """Take a frame as the snapshot and process it. Discards what was clicked before."""
        self.clicks = Clicks(frame, self.task, self.settings)
        self.draw()

    def forget(self) -> None:
        """There is no snapshot any more; its pictures stay until the next `draw`."""
        self.clicks = None

    def change_task(self, task: Task) -> None:
        """Of what was clicked, the last point is forgotten."""
        self.task = task
        if self.clicks is not None:
            self.clicks.change_task(task)
        self.draw()

    def set_sliders(self, values: dict[str, float], *, follow: bool) -> None:
        """Settings of the edge picture, each between 0 and 1.

        Args:
            values: By the names in `SLIDERS`; what is not named stays.
            follow: Whether the edge picture of the present snapshot is made anew.

        Raises:
            InputError: Unknown name or a value out of range; nothing changes then.
        """
        if not set(values) <= set(SLIDERS):
            raise InputError(
                f"slider '{min(set(values) - set(SLIDERS))}' is unknown; choose from {', '.join(sorted(SLIDERS))}"
            )
        self.settings = replace(self.settings, **values)
        if self.clicks is not None and follow:
            self.clicks.process(self.settings)
            self.draw()

    def set_fill(self, name: str) -> None:
        """What a click on the object is filled up to: surfaces or edges.

        Raises:
            InputError: Unknown name.
        """
        if name not in [fill.value for fill in Fill]:
            raise InputError(f"fill '{name}' is unknown; choose from surfaces, edges")
        self._fill = Fill(name)

    def click(self, u: float, v: float) -> None:
        """The object, then the grasp, then the cut or the place, in pixels of the snapshot.

        Raises:
            InputError: There is no snapshot, or what is wrong with the click.
        """
        if self.clicks is None:
            raise InputError("take a snapshot before you click")
        self.clicks.click(u, v, self._fill)
        self.draw()

    def back(self) -> None:
        """Take the last click back; before the first, the snapshot."""
        if self.clicks is not None and not self.clicks.back():
            self.clicks = None
        self.draw()

    def shown(self) -> dict[str, Any]:
        """Sliders, fill and task as plain values."""
        return {
            "sliders": {name: getattr(self.settings, name) for name in SLIDERS},
            "fill": self._fill.value,
            "task": self.task.value,
        }

    def draw(self) -> None:
        """Show what has been clicked; without a snapshot there is no edge picture."""
        if self.clicks is None:
            self._pictures.drop("edges")
            return
        for name, picture in self.clicks.pictures().items():
            self._pictures.show(name, picture)
