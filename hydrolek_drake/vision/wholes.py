"""From pieces of surface to whole objects: which pieces belong together."""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.spatial import cKDTree

from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.surfaces import Pieces, Surfaces

Mask = NDArray[np.bool_]

_BESIDE = 9  # px across: pieces this near to each other may belong together
_BEHIND = 41  # px across: a thing hides its neighbours, and the shadow of a thing at 0.8 m on one at 1.3 m some 20 px more
_FITTED = 400  # points of a piece
_BORDER = 15  # nearest pairs of these
_REGULAR = 1e-12  # of the eigenvalue problem
_AS_DEVIATION = 1.4826  # of a median of absolute values of a normal distribution


def whole_object(surfaces: Surfaces, pieces: Pieces, piece: int, scale: float = 1.0) -> Mask:
    """A piece with those that make one object with it, such as a cup's inside or what is beyond a bar before it.

    Two pieces, side by side or on both sides of something nearer, belong together if they are one surface: a quadric
    (plane, cylinder, ball, two faces of a box ...) fits both as well as each, the depth goes on from one to the other,
    and they fill their hull but for what is hidden. Side by side they do, too, if they fill their hull as well as each
    alone, unless the one in front bites into the other: then it stands before it or on it.

    Args:
        surfaces: Of the frame.
        pieces: Of the same.
        piece: Number of one.
        scale: What the thresholds are multiplied by: above 1 more is joined.
    """
    selected = pieces.numbers == piece
    tried = {0, piece}
    while True:
        joined = False
        for other, beside in _neighbours(surfaces.depth, pieces.numbers, selected, tried):
            tried.add(other)
            candidate = pieces.numbers == other
            joined = _one_surface(surfaces, selected, candidate, scale) or (
                beside and _one_shape(surfaces.depth, selected, candidate)
            )
            if joined:
                selected = selected | candidate
                tried = {0, *np.unique(pieces.numbers[selected]).tolist()}
                break
        if not joined:
            return without_holes(selected)


def _neighbours(
    depth: NDArray[np.float32], numbers: NDArray[np.int32], selected: Mask, tried: set[int]
) -> list[tuple[int, bool]]:
    """Pieces that may belong to it, and whether they are beside it or beyond something that is nearer."""
    beside, common = np.unique(numbers[_widened(selected, _BESIDE)], return_counts=True)
    found = [int(n) for n in beside[np.argsort(-common)] if int(n) not in tried]
    before = [
        int(n)
        for n in np.unique(numbers[_widened(selected, _BEHIND)])
        if n > 0
        and not selected[numbers == n].any()
        and _step(depth, selected, numbers == n, _BEHIND) > kinect_entries("wholes")["flush"]
    ]
    beyond: list[int] = []
    for n in before:
        beyond += [int(m) for m in np.unique(numbers[_widened(numbers == n, _BEHIND)])]
    others = [n for n in dict.fromkeys(beyond) if n not in tried and n not in found and n not in before]
    return [(n, True) for n in found] + [(n, False) for n in others]


def _widened(mask: Mask, size: int) -> Mask:
    return cv2.dilate(mask.astype(np.uint8), np.ones((size, size), np.uint8)).astype(bool)


def _one_shape(depth: NDArray[np.float32], a: Mask, b: Mask) -> bool:
    values = kinect_entries("wholes")
    convex_a, convex_b, together = _convexity(a), _convexity(b), _convexity(a | b)
    mean = float(np.average([convex_a, convex_b], weights=[a.sum(), b.sum()]))
    if together < min(values["convexity"], max(convex_a, convex_b)) - values["less"]:
        return False
    rounder, bitten = (a, b) if convex_a >= convex_b else (b, a)
    return together >= mean - values["less"] and _step(depth, rounder, bitten, _BESIDE) > -values["flush"]


def _one_surface(surfaces: Surfaces, a: Mask, b: Mask, scale: float) -> bool:
    values = kinect_entries("wholes")
    both = [_points(surfaces, mask) for mask in (a, b)]
    if min(len(each) for each in both) < 30:
        return False
    receding, aside = _gap(*both)
    if receding > scale * (values["receding"] * aside + values["gap"]):
        return False
    noise = values["noise"] * float(np.mean(np.vstack(both)[:, 2])) ** 2
    alone = max(noise, *(_roughness(each) for each in both))
    if _roughness(np.vstack(both)) > scale * values["rougher"] * alone:
        return False
    return _convexity(a | b | _hidden(surfaces.depth, a, b)) >= values["filled"] / scale


def _gap(a: NDArray[np.float64], b: NDArray[np.float64]) -> tuple[float, float]:
    """How far one recedes from the other where they are nearest, and how far they are apart sideways, in m."""
    seen_a, seen_b = (each[:, :2] / each[:, 2:] for each in (a, b))
    distance, index = cKDTree(seen_b).query(seen_a)
    nearest = np.argsort(distance)[:_BORDER]
    depth_a, depth_b = np.median(a[nearest, 2]), np.median(b[index[nearest], 2])
    aside = float(np.median(distance[nearest]) * min(depth_a, depth_b))
    return float(abs(depth_a - depth_b)), aside


def _hidden(depth: NDArray[np.float32], a: Mask, b: Mask) -> Mask:
    """What of the hull of both has no reading or is nearer than both."""
    rows, columns = np.nonzero(a | b)
    hull = cv2.convexHull(np.column_stack([columns, rows]).astype(np.int32))
    filled = np.zeros(depth.shape, np.uint8)
    cv2.fillConvexPoly(filled, hull, 1)
    nearest = np.percentile(depth[(a | b) & (depth > 0)], 5)
    return filled.astype(bool) & ((depth == 0.0) | (depth < nearest + kinect_entries("wholes")["flush"]))


def _points(surfaces: Surfaces, mask: Mask) -> NDArray[np.float64]:
    """Some of the points of a region, in the camera frame in m, shape (n, 3)."""
    rows, columns = np.nonzero(mask & (surfaces.depth > 0))
    step = max(1, len(rows) // _FITTED)
    rows, columns = rows[::step], columns[::step]
    return surfaces.camera.point(np.column_stack([columns, rows]), surfaces.depth[rows, columns])


def _roughness(points: NDArray[np.float64]) -> float:
    """Distance of points from the quadric that fits them best, in m: median, as a standard deviation.

    Taubin's fit: the algebraic distance over the mean gradient is least (IEEE PAMI 13, 1991), and the distance is
    taken to first order.
    """
    centred = points - points.mean(axis=0)
    size = float(centred.std())
    x, y, z = (centred / size).T
    one, none = np.ones_like(x), np.zeros_like(x)
    terms = np.column_stack([x * x, y * y, z * z, x * y, x * z, y * z, x, y, z, one])
    slopes = [
        np.column_stack([2 * x, none, none, y, z, none, one, none, none, none]),
        np.column_stack([none, 2 * y, none, x, none, z, none, one, none, none]),
        np.column_stack([none, none, 2 * z, none, x, y, none, none, one, none]),
    ]
    scatter, gradient = terms.T @ terms, sum(slope.T @ slope for slope in slopes)
    tiny = len(x) * np.eye(10)
    _, vectors = eigh(scatter + _REGULAR * tiny, gradient + 1e3 * _REGULAR * tiny, subset_by_index=[0, 0])
    steepness = np.sqrt(sum((slope @ vectors[:, 0]) ** 2 for slope in slopes))
    misses = np.abs(terms @ vectors[:, 0]) / np.maximum(steepness, 1e-3)
    return float(_AS_DEVIATION * np.median(misses) * size)


def _step(depth: NDArray[np.float32], a: Mask, b: Mask, within: int) -> float:
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
    outlines, _ = cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    hull = cv2.contourArea(cv2.convexHull(np.vstack(outlines)))
    return sum(cv2.contourArea(outline) for outline in outlines) / hull if hull > 0.0 else 1.0


def without_holes(mask: Mask) -> Mask:
    """The mask with what it encloses, but for its outline."""
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    outlines, _ = cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    filled = np.zeros_like(closed)
    cv2.drawContours(filled, outlines, -1, 1, cv2.FILLED)
    return filled.astype(bool)
