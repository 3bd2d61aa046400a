"""The object that the operator clicks on: thesis section 5.2.4, and the same from surfaces."""

from collections import Counter
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.edges import EdgeSettings, dilated, edge_picture
from hydrolek_drake.vision.surfaces import Pieces, Surfaces, cut_into_pieces
from hydrolek_drake.vision.wholes import Wholes, is_coherent

Mask = NDArray[np.bool_]

_RED = (0, 0, 255)  # blue, green, red
_MOST = 0.99  # of the sensitivity, which stays below 1


class Fill(Enum):
    """What the flood fill stops at."""

    SURFACES = "surfaces"
    """Jumps of depth, concave creases, large planes: the default."""
    EDGES = "edges"
    """The lines of the edge picture, as in the thesis."""


@dataclass(frozen=True)
class Snapshot:
    """One frame with all that the operator sees and clicks into.

    Attributes:
        colour: Blue, green, red, shape (h, w, 3).
        mask: What is within reach, shape (h, w).
        edges: The edge picture, 255 on lines, shape (h, w).
        surfaces: What the depth says.
        settings: The sliders.
    """

    colour: NDArray[np.uint8]
    mask: Mask
    edges: NDArray[np.uint8]
    surfaces: Surfaces
    settings: EdgeSettings
    _kept: dict[tuple[str, float], Any] = field(default_factory=dict, repr=False, compare=False)

    def pieces(self, scale: float) -> Pieces:
        """The pieces of surface with all thresholds times `scale`; kept."""
        return self._keep(("pieces", scale), lambda: cut_into_pieces(self.surfaces, scale))

    def wholes(self, scale: float) -> Wholes:
        """What objects these pieces make; kept."""
        return self._keep(("wholes", scale), lambda: Wholes(self.surfaces, self.pieces(scale)))

    def lines(self, scale: float) -> NDArray[np.uint8]:
        """The edge picture with the sensitivity times `scale`; kept."""
        if scale == 1.0:
            return self.edges
        changed = replace(self.settings, sensitivity=min(scale * self.settings.sensitivity, _MOST))
        return self._keep(("lines", scale), lambda: edge_picture(self.colour, self.mask, changed))

    def _keep(self, key: tuple[str, float], make: Callable[[], Any]) -> Any:
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]


@dataclass(frozen=True)
class _Outline:
    """What one try finds; tries of the same key find the same."""

    key: Hashable
    make: Callable[[], Mask]


@dataclass(frozen=True)
class Selection:
    """The object under a click, and how far that is certain.

    The same click is tried a little beside, and with the thresholds that cut surfaces, and those that join them,
    lowered and raised (`spread` in `kinect.yaml`). What most of these tries agree on is the object; what some of them
    find instead are the alternatives.

    Attributes:
        mask: The object, shape (h, w).
        agreement: Share of the tries that find the same outline, a refused click counting as another.
        alternatives: Other outlines, the most frequent first; each of shape (h, w).
        coherent: Whether the object is convex or one surface, as nearly every single thing is.
    """

    mask: Mask
    agreement: float
    alternatives: tuple[Mask, ...]
    coherent: bool

    @property
    def unsure(self) -> bool:
        """Whether a try finds something else, or this looks like two things."""
        return self.agreement < 1.0 or not self.coherent

    @property
    def warning(self) -> str:
        """What an operator should know, in a sentence; empty where it is certain."""
        if self.agreement < 1.0:
            return f"Unsure of this outline ({100 * self.agreement:.0f} % of the tries agree): check it."
        return "" if self.coherent else "Unsure of this outline (it looks like two things): check it."

    def next(self) -> "Selection":
        """With the first alternative as the object; the object so far becomes the last alternative."""
        if not self.alternatives:
            return self
        first, *rest = self.alternatives
        return replace(self, mask=first, alternatives=(*rest, self.mask))


def select_object(snapshot: Snapshot, pixel: tuple[float, float], fill: Fill = Fill.SURFACES) -> Selection:
    """The object around a click, and what else it might be.

    Args:
        snapshot: The frame.
        pixel: u to the right and v down, in px.
        fill: What the flood fill stops at.

    Raises:
        InputError: The click is outside the picture, on nothing within reach, on a large plane, or on a line.
    """
    height, width = snapshot.mask.shape
    u, v = round(pixel[0]), round(pixel[1])
    if not (0 <= u < width and 0 <= v < height):
        raise InputError(
            f"the click at ({u}, {v}) is outside the picture of {width} x {height}; click on an object"
        )
    if not snapshot.mask[v, u] and fill is Fill.EDGES:
        raise InputError(_nothing(u, v))
    as_set = _filled(snapshot, (u, v), fill, 1.0, 1.0)
    return _agreed(as_set, _tries(snapshot, (u, v), fill), snapshot.surfaces)


def _filled(
    snapshot: Snapshot, pixel: tuple[int, int], fill: Fill, scale: float, leniency: float
) -> _Outline:
    """The object around a click with all thresholds for cutting times `scale`, and for joining times `leniency`."""
    if fill is Fill.EDGES:
        mask = fill_between_lines(snapshot.lines(scale), snapshot.mask, pixel)
        return _Outline((scale, int(mask.argmax())), lambda: mask)
    u, v = pixel
    pieces = snapshot.pieces(scale)
    piece = _piece_at(pieces.numbers, u, v)
    if piece == 0:
        if not snapshot.mask[v, u]:
            raise InputError(_nothing(u, v))
        if not pieces.standing_out[v, u]:
            raise InputError(
                f"the click at ({u}, {v}) is on a wall, floor or table, not on an object that stands out of it"
            )
        raise InputError(
            f"the click at ({u}, {v}) is between objects; click further inside, or fill up to the lines instead"
        )
    wholes = snapshot.wholes(scale)
    return _joined(wholes, scale, wholes.members(piece, leniency))


def _joined(wholes: Wholes, scale: float, members: frozenset[int]) -> _Outline:
    return _Outline((scale, members), lambda: wholes.mask(members))


def _tries(snapshot: Snapshot, pixel: tuple[int, int], fill: Fill) -> list[_Outline | None]:
    """What the click and those beside it give with thresholds around those that stand; None where refused."""
    values = kinect_entries("selection")
    (u, v), beside = pixel, int(values["beside"])
    height, width = snapshot.mask.shape
    scales = [
        float(scale) for scale in np.geomspace(1 / values["spread"], values["spread"], int(values["scales"]))
    ]
    found: list[_Outline | None] = []
    for scale in scales:
        for leniency in scales if fill is Fill.SURFACES else [1.0]:
            for right, down in ((0, 0), (beside, 0), (-beside, 0), (0, beside), (0, -beside)):
                at = (min(max(u + right, 0), width - 1), min(max(v + down, 0), height - 1))
                try:
                    found.append(_filled(snapshot, at, fill, scale, leniency))
                except InputError:
                    found.append(None)
    if fill is Fill.SURFACES and (piece := _piece_at(snapshot.pieces(1.0).numbers, u, v)):
        wholes = snapshot.wholes(1.0)
        for other in wholes.plausible(piece, values["spread"]):
            found.append(_joined(wholes, 1.0, wholes.members(piece, 1.0, other)))
        members = wholes.members(piece, 1.0)
        found.append(_Outline(("with leftovers", members), lambda: wholes.with_leftovers(members)))
    return found


def _agreed(as_set: _Outline, tries: list[_Outline | None], surfaces: Surfaces) -> Selection:
    """The outline that most tries agree with, and the others."""
    values = kinect_entries("selection")
    counts = Counter(outline.key for outline in tries if outline is not None)
    outlines = {outline.key: outline.make for outline in (as_set, *tries) if outline is not None}
    kinds: list[tuple[Mask, int]] = []
    for key, make in outlines.items():
        mask = make()
        for index, (kind, count) in enumerate(kinds):
            if _overlap(mask, kind) >= values["same"]:
                kinds[index] = (kind, count + counts[key])
                break
        else:
            kinds.append((mask, counts[key]))
    kinds.sort(key=lambda kind: -kind[1])
    first, count = kinds[0]
    return Selection(
        first, count / len(tries), tuple(mask for mask, _ in kinds[1:]), is_coherent(surfaces, first)
    )


def _overlap(a: Mask, b: Mask) -> float:
    return int(np.count_nonzero(a & b)) / max(1, int(np.count_nonzero(a | b)))


def _nothing(u: int, v: int) -> str:
    return (
        f"the click at ({u}, {v}) is on nothing within reach: no depth there, or too far; move the machine "
        "nearer or click on an object"
    )


def fill_between_lines(edges: NDArray[np.uint8], mask: Mask, pixel: tuple[int, int]) -> Mask:
    """Flood fill from the click up to the lines of the edge picture; the object alone, as in 5.2.4.

    The picture's border and the end of reach count as lines too.

    Raises:
        InputError: The click is on a line.
    """
    u, v = pixel
    if edges[v, u]:
        raise InputError(f"the click at ({u}, {v}) is on a line; click between the lines, inside the object")
    barrier = np.zeros((edges.shape[0] + 2, edges.shape[1] + 2), np.uint8)
    barrier[1:-1, 1:-1] = (edges > 0) | ~mask
    canvas = np.zeros_like(edges)
    cv2.floodFill(canvas, barrier, (u, v), 1, flags=4 | (255 << 8))
    return canvas.astype(bool)


def perimeter(selected: Mask) -> NDArray[np.uint8]:
    """Perimeter of the object, dilated as the edges are; 255 on it (5.2.4)."""
    inner = cv2.erode(selected.astype(np.uint8), cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3)))
    return dilated(((selected.astype(np.uint8) - inner) * 255).astype(np.uint8))


def overlay(colour: NDArray[np.uint8], selected: Mask) -> NDArray[np.uint8]:
    """The colour picture with the object's perimeter in red, for the operator to confirm (5.2.4)."""
    picture = colour.copy()
    picture[perimeter(selected) > 0] = _RED
    return picture


def _piece_at(pieces: NDArray[np.int32], u: int, v: int) -> int:
    """The piece at a pixel, or the nearest within 3 px: a finger is not that steady."""
    if pieces[v, u] > 0:
        return int(pieces[v, u])
    window = pieces[max(0, v - 3) : v + 4, max(0, u - 3) : u + 4]
    rows, columns = np.nonzero(window)
    if not len(rows):
        return 0
    far = (rows - min(v, 3)) ** 2 + (columns - min(u, 3)) ** 2
    return int(window[rows[far.argmin()], columns[far.argmin()]])
