"""From pieces of surface to whole objects: which pieces belong together."""

from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects

from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.region_shape import (
    BESIDE,
    FAR_APART,
    FEWEST,
    RIM,
    concavity,
    convexity,
    depth_step,
    off_convex,
    off_going_on,
    off_one_shape,
    without_rim,
)
from hydrolek_drake.vision.surface_kernel import grow
from hydrolek_drake.vision.surfaces import Pieces, Surfaces

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Window = tuple[slice, slice]

_STRIDE = 2  # px: what is behind something is looked for at half resolution; the following are of that
_BEHIND = 21  # px across: a thing hides its neighbours
_ACROSS = 5  # px across: the same of what has no depth, halves of which belong to those around it
_SHADED = 15  # px: half of the shadow of what is at 0.6 m on what is at 1.5 m
_CLOSED = 4  # px around a region, for closing its gaps
_FITTED = 200  # points of a piece
_SURELY = 0.5  # threshold: what is nearer is not looked at more closely
_HARDLY = 0.01  # concavity: less counts as this


class Wholes:
    """The objects that the pieces of one cut make up.

    Two pieces, side by side or on both sides of something nearer or without depth, belong together if the depth goes on
    from one to the other, and they are convex: in space, their points lie on their convex hull; in the picture, they
    fill it but for what is hidden. Side by side they do, too, if one is concave, such as the inside of a cup, and they
    fill their hull in the picture as well as each alone, unless the one in front bites into the other: then it stands
    before it or in it.

    How far two pieces are from belonging together is one number, the largest of these quantities over their thresholds
    in `kinect.yaml`: below 1 they do, as the thresholds stand.

    Args:
        surfaces: Of the frame.
        pieces: Of the same.
    """

    def __init__(self, surfaces: Surfaces, pieces: Pieces) -> None:
        self._depth, self._surfaces, self._numbers = surfaces.depth, surfaces, pieces.numbers
        self._boxes = find_objects(pieces.numbers)
        self._standing_out = pieces.standing_out
        self._left: NDArray[np.int32] | None = None
        self._coarse = np.ascontiguousarray(pieces.numbers[::_STRIDE, ::_STRIDE])
        self._shaded = self._coarse.copy()  # and what has no depth around them, such as their shadows
        no_depth = (surfaces.depth[::_STRIDE, ::_STRIDE] == 0.0).astype(np.uint8)
        grow(self._shaded, cv2.dilate(no_depth, np.ones((5, 5), np.uint8)), 0, _SHADED)
        self._near: dict[tuple[int, int], frozenset[int]] = {}
        self._before: dict[tuple[int, int], bool] = {}
        self._candidates_of: dict[frozenset[int], list[tuple[int, bool]]] = {}
        self._apart: dict[tuple[frozenset[int], int, bool], float] = {}
        self._points: dict[int, Array] = {}

    def members(self, piece: int, leniency: float, other: int | None = None) -> frozenset[int]:
        """The pieces that make one object with a piece, and itself.

        Args:
            piece: Its number.
            leniency: What the thresholds are multiplied by: above 1 more is joined.
            other: Of another piece that belongs to it, if given.
        """
        members = frozenset({piece} if other is None else {piece, other})
        while True:
            nearest = min(
                (
                    (self._apartness(members, *candidate), candidate[0])
                    for candidate in self._candidates(members)
                ),
                default=(np.inf, 0),
            )
            if not nearest[0] < leniency:
                return members
            members |= {nearest[1]}

    def plausible(self, piece: int, leniency: float) -> list[int]:
        """Pieces that may each belong to a piece, beyond two things, too, by thresholds times `leniency`."""
        members = frozenset({piece})
        candidates = dict(self._candidates(members))
        for before in self._nearby(piece, _BEHIND):
            if self._hides(before, piece):
                for further in self._nearby(before, _BEHIND):
                    candidates |= {
                        n: False for n in self._nearby(further, _BEHIND) - members - set(candidates)
                    }
        return [
            other
            for other, beside in candidates.items()
            if self._apartness(members, other, beside) < leniency
        ]

    def with_leftovers(self, members: frozenset[int]) -> Mask:
        """The outline of an object with what stands out beside it, but is too small for a piece; shape (h, w)."""
        mask = self.mask(members)
        window = self._window(members, BESIDE)
        around = cv2.dilate(mask[window].astype(np.uint8), np.ones((BESIDE, BESIDE), np.uint8)) > 0
        if self._left is None:
            left = (self._standing_out & (self._numbers == 0)).astype(np.uint8)
            self._left = cv2.connectedComponents(left)[1]
        touching = np.bincount(self._left[window][around], minlength=int(self._left.max()) + 1) > 0
        touching[0] = False
        return mask | touching[self._left]

    def mask(self, members: frozenset[int]) -> Mask:
        """The outline of an object that consists of these pieces, filled; shape (h, w)."""
        window = self._window(members, _CLOSED)
        mask = np.zeros(self._numbers.shape, bool)
        mask[window] = without_holes(self._within(window, members))
        return mask

    def _window(self, members: Iterable[int], margin: int) -> Window:
        """Rows and columns of these pieces with a margin in px around them."""
        boxes = [self._boxes[number - 1] for number in members]
        edges = []
        for axis, end in enumerate(self._numbers.shape):
            first, last = min(box[axis].start for box in boxes), max(box[axis].stop for box in boxes)
            edges.append(slice(max(0, first - margin), min(end, last + margin)))
        return edges[0], edges[1]

    def _coarse_window(self, members: Iterable[int], margin: int) -> Window:
        """The same at half resolution."""
        rows, columns = (
            slice(each.start // _STRIDE, -(-each.stop // _STRIDE))
            for each in self._window(members, _STRIDE * margin)
        )
        return rows, columns

    def _within(self, window: Window, members: Iterable[int]) -> Mask:
        numbers = self._numbers[window]
        return np.logical_or.reduce([numbers == number for number in members])

    def _nearby(self, piece: int, size: int) -> frozenset[int]:
        """Other pieces within so many px across of a piece."""
        if (piece, size) not in self._near:
            if size == BESIDE:
                numbers = self._numbers[self._window({piece}, size // 2 + 1)]
            else:
                numbers = self._shaded[self._coarse_window({piece}, size // 2 + 1 + _SHADED)]
            it = (numbers == piece).astype(np.uint8)
            around = cv2.dilate(it, np.ones((size, size), np.uint8)) > 0
            found = np.flatnonzero(np.bincount(numbers[around]))
            self._near[piece, size] = frozenset(found.tolist()) - {0, piece}
        return self._near[piece, size]

    def _is_before(self, piece: int, other: int) -> bool:
        """Whether a piece near another is nearer to the camera where they border."""
        if (piece, other) not in self._before:
            window = self._coarse_window({piece, other}, 1)
            numbers, depth = self._coarse[window], self._depth[::_STRIDE, ::_STRIDE][window]
            step = depth_step(depth, numbers == other, numbers == piece, _BEHIND + 2 * _SHADED)
            self._before[piece, other] = step > kinect_entries("wholes")["flush"]
        return self._before[piece, other]

    def _candidates(self, members: frozenset[int]) -> list[tuple[int, bool]]:
        """Pieces that may belong to these, and whether they are beside them or beyond something that is nearer."""
        if members not in self._candidates_of:
            beside = {n for member in members for n in self._nearby(member, BESIDE)}
            around = {n for member in members for n in self._nearby(member, _BEHIND)} - members
            before = [n for n in around if any(self._hides(n, member) for member in members)]
            beyond = {m for n in before for m in self._nearby(n, _BEHIND)}
            beyond |= {m for member in members for m in self._nearby(member, _ACROSS)}
            found = [(n, True) for n in sorted(beside - members)]
            self._candidates_of[members] = found + [(n, False) for n in sorted(beyond - beside - members)]
        return self._candidates_of[members]

    def _hides(self, piece: int, member: int) -> bool:
        return piece in self._nearby(member, _BEHIND) and self._is_before(piece, member)

    def _apartness(self, members: frozenset[int], other: int, beside: bool) -> float:
        """How far pieces are from belonging together: below 1 they do, as the thresholds stand."""
        key = (members, other, beside)
        if key not in self._apart:
            window = self._window(members | {other}, _CLOSED)
            a, b = self._within(window, members), self._within(window, {other})
            both = [self._some_points(members), self._some_points({other})]
            depth = self._depth[window]
            apart = np.inf
            if min(len(each) for each in both) >= FEWEST:
                if beside and (apart := off_one_shape(depth, a, b)) < FAR_APART:
                    apart = max(apart, 1.0 / max(_HARDLY, *(concavity(each) for each in both)))
                if apart > _SURELY and (receding := off_going_on(*both)) < FAR_APART:
                    apart = min(apart, max(receding, off_convex(np.vstack(both), depth, a, b)))
            self._apart[key] = apart
        return self._apart[key]

    def _some_points(self, members: Iterable[int]) -> Array:
        """Some of the points of pieces, in the camera frame in m, shape (n, 3)."""
        chosen = []
        for number in members:
            if number not in self._points:
                window = self._window({number}, RIM)
                within = self._within(window, {number}) & (self._depth[window] > 0)
                rows, columns = np.nonzero(without_rim(within))
                rows, columns = rows + window[0].start, columns + window[1].start
                pixels = np.column_stack([columns, rows])
                self._points[number] = self._surfaces.camera.point(pixels, self._depth[rows, columns])
            chosen.append(self._points[number])
        points = np.vstack(chosen)
        return points[:: max(1, len(points) // _FITTED)]


def is_coherent(surfaces: Surfaces, mask: Mask) -> bool:
    """Whether an object is convex in space or in the picture, as nearly every single thing is."""
    values = kinect_entries("wholes")
    if convexity(mask) >= values["coherent"]:
        return True
    rows, columns = np.nonzero(without_rim(mask & (surfaces.depth > 0)))
    if len(rows) < FEWEST:
        return True
    step = max(1, len(rows) // _FITTED)
    rows, columns = rows[::step], columns[::step]
    points = surfaces.camera.point(np.column_stack([columns, rows]), surfaces.depth[rows, columns])
    return concavity(points) <= 1.0


def without_holes(mask: Mask) -> Mask:
    """The mask with what it encloses, but for its outline."""
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    outlines, _ = cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    filled = np.zeros_like(closed)
    cv2.drawContours(filled, outlines, -1, 1, cv2.FILLED)
    return filled.astype(bool)
