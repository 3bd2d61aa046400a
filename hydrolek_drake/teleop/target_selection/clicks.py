"""What the operator clicks, task by task: object, grasp, and cut or place; and how it is shown (5.2.4, 5.2.5)."""

import math
from enum import Enum
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.edges import EdgeSettings
from hydrolek_drake.vision.frames import Frame
from hydrolek_drake.vision.place import level_place
from hydrolek_drake.vision.selection import Fill, Mask, Selection, Snapshot, overlay, select_object
from hydrolek_drake.vision.snapshot import take_snapshot
from hydrolek_drake.vision.targets import PipeTargets, PixelTargets, pipe_targets, pixel_targets
from hydrolek_drake.workcell.pipe import workcell_entries

Array = NDArray[np.float64]
Pictures = dict[str, NDArray[np.uint8]]

_GREEN, _MAGENTA, _YELLOW, _ORANGE = (
    (80, 220, 80),
    (255, 0, 255),
    (0, 220, 255),
    (0, 140, 255),
)  # blue, green, red


class Task(Enum):
    """What the clicks are for."""

    CUT = "cut"
    PLACE = "place"


class Wanted(Enum):
    """What is to be clicked next."""

    OBJECT = "object"
    GRASP = "grasp"
    CUT = "cut"
    PLACE = "place"
    NOTHING = ""


class Clicks:
    """Clicks into one frame. Nothing of a wrong click is kept.

    Args:
        frame: What was photographed.
        task: What the clicks are for.
        settings: Of the edge picture.

    Attributes:
        frame: As given.
        task: As given, or as changed by `change_task`.
        targets: Of the pipe in the camera frame, once all has been clicked.
        place: Where it is put down, in the camera frame in m, shape (3,), for the task that has a place.
    """

    def __init__(self, frame: Frame, task: Task, settings: EdgeSettings) -> None:
        self.frame, self.task = frame, task
        self.targets: PipeTargets | None = None
        self.place: Array | None = None
        self._place_at: tuple[float, float] | None = None
        self._selection: Selection | None = None
        self._object_at = (0.0, 0.0)
        self._grasp: tuple[float, float] | None = None
        self._pixels: PixelTargets | None = None
        self._snapshot: Snapshot
        self.process(settings)

    def process(self, settings: EdgeSettings) -> None:
        """Make the edge picture anew."""
        frame = self.frame
        self._snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, settings)

    def wanted(self) -> Wanted:
        """What is to be clicked next."""
        if self._selection is None:
            return Wanted.OBJECT
        if self._grasp is None:
            return Wanted.GRASP
        if self.targets is None:
            return Wanted.CUT if self.task is Task.CUT else Wanted.PLACE
        return Wanted.NOTHING

    def click(self, u: float, v: float, fill: Fill) -> None:
        """Take the next click.

        While it is unsure what the object is, a click at the place where it was clicked shows what else it might be.

        Raises:
            InputError: What is wrong with it, or that none is wanted.
        """
        if not (np.isfinite(u) and np.isfinite(v)):
            raise InputError("a click needs two finite numbers")
        match self.wanted():
            case Wanted.OBJECT:
                self._selection, self._object_at = select_object(self._snapshot, (u, v), fill), (u, v)
            case Wanted.GRASP if self._asks_for_another(u, v):
                assert self._selection is not None
                self._selection = self._selection.next()
            case Wanted.GRASP:
                self._targets_at((u, v), (u, v))
                self._grasp = (u, v)
            case Wanted.CUT:
                assert self._grasp is not None
                self._pixels, self.targets = self._fitted(self._grasp, (u, v))
            case Wanted.PLACE:
                self._click_place((u, v))
            case _:
                raise InputError("no click is needed now; confirm, or go back")

    def back(self) -> bool:
        """Take the last click back; False if there was none."""
        if self.targets is not None:
            self._forget_last()
        elif self._grasp is not None:
            self._grasp = None
        elif self._selection is not None:
            self._selection = None
        else:
            return False
        return True

    def change_task(self, task: Task) -> None:
        """Object and grasp stay, the last point is to be clicked anew."""
        if task is not self.task:
            self.task = task
            self._forget_last()

    def told(self) -> str:
        """What the operator should know about the object, in a sentence; may be empty."""
        if self.targets is not None:
            return f"Pipe of {2e3 * self.targets.cylinder.radius:.0f} mm."
        if self._selection is None or not self.unsure():
            return ""
        count = len(self._selection.alternatives)
        others = "another" if count == 1 else f"one of {count} others"
        offer = f" A click at the same place shows {others}." if count else ""
        return self._selection.warning + offer

    def unsure(self) -> bool:
        """Whether the outline of the object is to be checked before the next click."""
        return self.wanted() is Wanted.GRASP and self._selection is not None and self._selection.unsure

    def pictures(self) -> Pictures:
        """`colour` and `edges` with the marks of what has been clicked."""
        edges, colour = self._snapshot.edges, self._snapshot.colour
        shown = cv2.cvtColor(edges, cv2.COLOR_GRAY2BGR)
        if self._selection is not None:
            shown = np.zeros_like(shown)
            shown[self._selection.mask] = 255
            colour = overlay(colour, self._selection.mask)
        colour = colour.copy()
        if self._grasp is not None:
            pixels = self._pixels or self._targets_at(self._grasp, self._grasp)
            for picture in (colour, shown):
                _mark(picture, pixels, with_cut=self._pixels is not None)
                if self._place_at is not None:
                    _mark_place(picture, pixels, self._place_at)
        return {"colour": colour, "edges": shown}

    def _click_place(self, at: tuple[float, float]) -> None:
        assert self._grasp is not None
        values = workcell_entries()["place"]
        place = level_place(
            self._snapshot,
            self._selected(),
            at,
            self.frame.camera,
            around=int(values["around"]),
            steepest=math.radians(values["level_deg"]),
        )
        _, self.targets = self._fitted(self._grasp, self._grasp)
        self.place, self._place_at = place, at

    def _asks_for_another(self, u: float, v: float) -> bool:
        """Whether this click, the one after the object's, is at the same place, while the object is unsure."""
        apart = math.hypot(u - self._object_at[0], v - self._object_at[1])
        others = self._selection.alternatives if self._selection is not None else ()
        return self.unsure() and len(others) > 0 and apart <= kinect_entries("selection")["again"]

    def _selected(self) -> Mask:
        assert self._selection is not None
        return self._selection.mask

    def _forget_last(self) -> None:
        self._pixels = self.targets = self.place = self._place_at = None

    def _fitted(
        self, grasp: tuple[float, float], cut: tuple[float, float]
    ) -> tuple[PixelTargets, PipeTargets]:
        pixels = self._targets_at(grasp, cut)
        return pixels, pipe_targets(self._snapshot, self._selected(), pixels, self.frame.camera)

    def _targets_at(self, grasp: tuple[float, float], cut: tuple[float, float]) -> PixelTargets:
        return pixel_targets(self._snapshot, self._selected(), grasp, cut, self.frame.camera)


def _whole(point: Any) -> tuple[int, int]:
    return round(point[0]), round(point[1])


def _mark(picture: NDArray[np.uint8], pixels: PixelTargets, *, with_cut: bool) -> None:
    """Grasp as a green ring, centre line yellow, cut magenta, drawn into the picture."""
    cv2.line(picture, _whole(pixels.line.ends[0]), _whole(pixels.line.ends[1]), _YELLOW, 1, cv2.LINE_AA)
    cv2.circle(picture, _whole(pixels.grasp), 9, _GREEN, 3, cv2.LINE_AA)
    if with_cut:
        cv2.line(picture, _whole(pixels.cut_ends[0]), _whole(pixels.cut_ends[1]), _MAGENTA, 3, cv2.LINE_AA)


def _mark_place(picture: NDArray[np.uint8], pixels: PixelTargets, at: tuple[float, float]) -> None:
    """An orange cross where the pipe is put down, and an arrow to it from the grasp."""
    cv2.drawMarker(picture, _whole(at), _ORANGE, cv2.MARKER_TILTED_CROSS, 20, 3, cv2.LINE_AA)
    cv2.arrowedLine(picture, _whole(pixels.grasp), _whole(at), _ORANGE, 1, cv2.LINE_AA, tipLength=0.05)
