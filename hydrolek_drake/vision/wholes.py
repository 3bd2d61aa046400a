"""From pieces of surface to whole objects: which pieces belong together."""

from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects
from scipy.spatial import ConvexHull, QhullError, cKDTree

from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.surface_kernel import grow
from hydrolek_drake.vision.surfaces import Pieces, Surfaces

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]
Window = tuple[slice, slice]

_BESIDE = 9  # px across: pieces this near to each other may belong together
_STRIDE = 2  # px: what is behind something is looked for at half resolution; the following are of that
_BEHIND = 21  # px across: a thing hides its neighbours
_ACROSS = 5  # px across: the same of what has no depth, halves of which belong to those around it
_SHADED = 15  # px: half of the shadow of what is at 0.6 m on what is at 1.5 m
_RIM = 5  # px across, of what is left out at the edge of a piece
_CLOSED = 4  # px around a region, for closing its gaps
_FITTED = 200  # points of a piece
_FEWEST = 30  # points of a piece that is judged
_FAR_APART, _SURELY = 2.0, 0.5  # thresholds: what is farther, or nearer, is not looked at more closely
_BORDER = 15  # nearest pairs of these
_NEARLY_ALL = 95  # percent
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
        window = self._window(members, _BESIDE)
        around = cv2.dilate(mask[window].astype(np.uint8), np.ones((_BESIDE, _BESIDE), np.uint8)) > 0
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
            if size == _BESIDE:
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
            step = _step(depth, numbers == other, numbers == piece, _BEHIND + 2 * _SHADED)
            self._before[piece, other] = step > kinect_entries("wholes")["flush"]
        return self._before[piece, other]

    def _candidates(self, members: frozenset[int]) -> list[tuple[int, bool]]:
        """Pieces that may belong to these, and whether they are beside them or beyond something that is nearer."""
        if members not in self._candidates_of:
            beside = {n for member in members for n in self._nearby(member, _BESIDE)}
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
            if min(len(each) for each in both) >= _FEWEST:
                if beside and (apart := _off_one_shape(depth, a, b)) < _FAR_APART:
                    apart = max(apart, 1.0 / max(_HARDLY, *(_concavity(each) for each in both)))
                if apart > _SURELY and (receding := _off_going_on(*both)) < _FAR_APART:
                    apart = min(apart, max(receding, _off_convex(np.vstack(both), depth, a, b)))
            self._apart[key] = apart
        return self._apart[key]

    def _some_points(self, members: Iterable[int]) -> Array:
        """Some of the points of pieces, in the camera frame in m, shape (n, 3)."""
        chosen = []
        for number in members:
            if number not in self._points:
                window = self._window({number}, _RIM)
                within = self._within(window, {number}) & (self._depth[window] > 0)
                rows, columns = np.nonzero(_without_rim(within))
                rows, columns = rows + window[0].start, columns + window[1].start
                pixels = np.column_stack([columns, rows])
                self._points[number] = self._surfaces.camera.point(pixels, self._depth[rows, columns])
            chosen.append(self._points[number])
        points = np.vstack(chosen)
        return points[:: max(1, len(points) // _FITTED)]


def _without_rim(mask: Mask) -> Mask:
    """A region without its rim, where the depth may be half of what is beside it; all of it if nothing else is left."""
    inner = cv2.erode(mask.astype(np.uint8), np.ones((_RIM, _RIM), np.uint8)).astype(bool)
    return inner if np.count_nonzero(inner) >= _FEWEST else mask


def _off_one_shape(depth: Floats, a: Mask, b: Mask) -> float:
    """How far two regions side by side are from filling their hull as well together as alone; below 1 they do."""
    values = kinect_entries("wholes")
    convex_a, convex_b, together = _convexity(a), _convexity(b), _convexity(a | b)
    mean = float(np.average([convex_a, convex_b], weights=[a.sum(), b.sum()]))
    wanted = max(mean, min(values["convexity"], max(convex_a, convex_b)))
    rounder, bitten = (a, b) if convex_a >= convex_b else (b, a)
    return max(
        (wanted - together) / values["less"], -_step(depth, rounder, bitten, _BESIDE) / values["flush"]
    )


def _off_going_on(a: Array, b: Array) -> float:
    """How far the depth is from going on from one region to another, where they are nearest; below 1 it does."""
    values = kinect_entries("wholes")
    seen_a, seen_b = (each[:, :2] / each[:, 2:] for each in (a, b))
    least = max(a[:, 2].min() - b[:, 2].max(), b[:, 2].min() - a[:, 2].max())
    most_aside = np.linalg.norm(seen_a.mean(axis=0) - seen_b.mean(axis=0)) * max(a[:, 2].max(), b[:, 2].max())
    if least > _FAR_APART * (values["receding"] * most_aside + values["gap"]):
        return np.inf
    distance, index = cKDTree(seen_b).query(seen_a)
    nearest = np.argpartition(distance, min(_BORDER, len(distance) - 1))[:_BORDER]
    depth_a, depth_b = np.median(a[nearest, 2]), np.median(b[index[nearest], 2])
    aside = np.median(distance[nearest]) * min(depth_a, depth_b)
    return float(abs(depth_a - depth_b) / (values["receding"] * aside + values["gap"]))


def _off_convex(points: Array, depth: Floats, a: Mask, b: Mask) -> float:
    """How far two regions are from being seen to be convex together, in space and in the picture; below 1 they are."""
    values = kinect_entries("wholes")
    hidden = _hidden(depth, a, b)
    all_of_it = a | b | hidden
    unseen = np.count_nonzero(hidden & ~a & ~b) / np.count_nonzero(all_of_it)
    off = max(unseen / values["unseen"], (1.0 - _convexity(all_of_it)) / values["unfilled"])
    return off if off > _FAR_APART else max(off, _concavity(points))


def _concavity(points: Array) -> float:
    """How concave a region is: 0 where it is no more than noise makes it, 1 at the threshold."""
    values = kinect_entries("wholes")
    over_noise = _concavity_m(points) / (values["noise"] * float(np.mean(points[:, 2])) ** 2)
    return (over_noise - values["flat"]) / (values["concave"] - values["flat"])


def _hidden(depth: Floats, a: Mask, b: Mask) -> Mask:
    """What of the hull of both has no reading or is nearer than both."""
    outlines, _ = cv2.findContours((a | b).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    filled = np.zeros(depth.shape, np.uint8)
    cv2.fillConvexPoly(filled, cv2.convexHull(np.vstack(outlines)), 1)
    nearest = np.percentile(depth[(a | b) & (depth > 0)], 5)
    return filled.astype(bool) & ((depth == 0.0) | (depth < nearest + kinect_entries("wholes")["flush"]))


def _concavity_m(points: Array) -> float:
    """How far nearly all points lie below the side of their convex hull that the camera sees, in m.

    The points of a convex thing lie on their hull, whatever of it is hidden; between two things it is concave.
    Noise lifts the hull by some 3 standard deviations above a surface, and a twentieth of the points lies 1.6 below.
    """
    try:
        facets = ConvexHull(points).equations  # normals outwards, and minus their distance from the origin
    except QhullError:  # all in one plane, by the steps of the sensor
        return 0.0
    seen = facets[facets[:, 3] > 0.0]
    below = -(points @ seen[:, :3].T + seen[:, 3]).max(axis=1)
    return float(np.percentile(below, _NEARLY_ALL))


def _step(depth: Floats, a: Mask, b: Mask, within: int) -> float:
    """Median depth of `a` less that of `b` where they border, that is within so many px across, in m."""
    kernel = np.ones((within, within), np.uint8)
    at_a = a & cv2.dilate(b.astype(np.uint8), kernel).astype(bool) & (depth > 0)
    at_b = b & cv2.dilate(a.astype(np.uint8), kernel).astype(bool) & (depth > 0)
    if not at_a.any() or not at_b.any():
        return 0.0
    return float(np.median(depth[at_a]) - np.median(depth[at_b]))


def _convexity(mask: Mask) -> float:
    """Share of its convex hull that a region fills, holes counted as filled."""
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((7, 7), np.uint8))
    outlines, _ = cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    hull = cv2.contourArea(cv2.convexHull(np.vstack(outlines)))
    return sum(cv2.contourArea(outline) for outline in outlines) / hull if hull > 0.0 else 1.0


def is_coherent(surfaces: Surfaces, mask: Mask) -> bool:
    """Whether an object is convex in space or in the picture, as nearly every single thing is."""
    values = kinect_entries("wholes")
    if _convexity(mask) >= values["coherent"]:
        return True
    rows, columns = np.nonzero(_without_rim(mask & (surfaces.depth > 0)))
    if len(rows) < _FEWEST:
        return True
    step = max(1, len(rows) // _FITTED)
    rows, columns = rows[::step], columns[::step]
    points = surfaces.camera.point(np.column_stack([columns, rows]), surfaces.depth[rows, columns])
    return _concavity(points) <= 1.0


def without_holes(mask: Mask) -> Mask:
    """The mask with what it encloses, but for its outline."""
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    outlines, _ = cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    filled = np.zeros_like(closed)
    cv2.drawContours(filled, outlines, -1, 1, cv2.FILLED)
    return filled.astype(bool)
