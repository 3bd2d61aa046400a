"""Shapes of regions of a depth picture: how convex each is, and how far two are from being one thing."""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError, cKDTree

from hydrolek_drake.vision.configuration import kinect_entries

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Mask = NDArray[np.bool_]

BESIDE = 9
"""px across: regions this near to each other border."""
RIM = 5
"""px across, of what is left out at the edge of a region."""
FEWEST = 30
"""Points of a region that is judged."""
FAR_APART = 2.0
"""Thresholds: what is farther is not looked at more closely."""
_BORDER = 15  # nearest pairs of these
_NEARLY_ALL = 95  # percent


def without_rim(mask: Mask) -> Mask:
    """A region without its rim, where the depth may be half of what is beside it; all of it if nothing else is left.

    Args:
        mask: Of the region, shape (h, w).
    """
    inner = cv2.erode(mask.astype(np.uint8), np.ones((RIM, RIM), np.uint8)).astype(bool)
    return inner if np.count_nonzero(inner) >= FEWEST else mask


def off_one_shape(depth: Floats, a: Mask, b: Mask) -> float:
    """How far two regions side by side are from filling their hull as well together as alone; below 1 they do.

    Args:
        depth: Picture in m, 0 where there is none, shape (h, w).
        a: Region, shape (h, w).
        b: Likewise.
    """
    values = kinect_entries("wholes")
    convex_a, convex_b, together = convexity(a), convexity(b), convexity(a | b)
    mean = float(np.average([convex_a, convex_b], weights=[a.sum(), b.sum()]))
    wanted = max(mean, min(values["convexity"], max(convex_a, convex_b)))
    rounder, bitten = (a, b) if convex_a >= convex_b else (b, a)
    return max(
        (wanted - together) / values["less"], -depth_step(depth, rounder, bitten, BESIDE) / values["flush"]
    )


def off_going_on(a: Array, b: Array) -> float:
    """How far the depth is from going on from one region to another, where they are nearest; below 1 it does.

    Args:
        a: Points of a region in the camera frame in m, shape (n, 3).
        b: Likewise of another one.
    """
    values = kinect_entries("wholes")
    seen_a, seen_b = (each[:, :2] / each[:, 2:] for each in (a, b))
    least = max(a[:, 2].min() - b[:, 2].max(), b[:, 2].min() - a[:, 2].max())
    most_aside = np.linalg.norm(seen_a.mean(axis=0) - seen_b.mean(axis=0)) * max(a[:, 2].max(), b[:, 2].max())
    if least > FAR_APART * (values["receding"] * most_aside + values["gap"]):
        return np.inf
    distance, index = cKDTree(seen_b).query(seen_a)
    nearest = np.argpartition(distance, min(_BORDER, len(distance) - 1))[:_BORDER]
    depth_a, depth_b = np.median(a[nearest, 2]), np.median(b[index[nearest], 2])
    aside = np.median(distance[nearest]) * min(depth_a, depth_b)
    return float(abs(depth_a - depth_b) / (values["receding"] * aside + values["gap"]))


def off_convex(points: Array, depth: Floats, a: Mask, b: Mask) -> float:
    """How far two regions are from being seen to be convex together, in space and in the picture; below 1 they are.

    Args:
        points: Of both in the camera frame in m, shape (n, 3).
        depth: Picture in m, 0 where there is none, shape (h, w).
        a: Region, shape (h, w).
        b: Likewise.
    """
    values = kinect_entries("wholes")
    hidden = _hidden(depth, a, b)
    all_of_it = a | b | hidden
    unseen = np.count_nonzero(hidden & ~a & ~b) / np.count_nonzero(all_of_it)
    off = max(unseen / values["unseen"], (1.0 - convexity(all_of_it)) / values["unfilled"])
    return off if off > FAR_APART else max(off, concavity(points))


def concavity(points: Array) -> float:
    """How concave a region is: 0 where it is no more than noise makes it, 1 at the threshold.

    Args:
        points: In the camera frame in m, shape (n, 3).
    """
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


def depth_step(depth: Floats, a: Mask, b: Mask, within: int) -> float:
    """Median depth of `a` less that of `b` where they border, that is within so many px across, in m.

    Args:
        depth: Picture in m, 0 where there is none, shape (h, w).
        a: Region, shape (h, w).
        b: Likewise.
        within: px across.
    """
    kernel = np.ones((within, within), np.uint8)
    at_a = a & cv2.dilate(b.astype(np.uint8), kernel).astype(bool) & (depth > 0)
    at_b = b & cv2.dilate(a.astype(np.uint8), kernel).astype(bool) & (depth > 0)
    if not at_a.any() or not at_b.any():
        return 0.0
    return float(np.median(depth[at_a]) - np.median(depth[at_b]))


def convexity(mask: Mask) -> float:
    """Share of its convex hull that a region fills, holes counted as filled.

    Args:
        mask: Of the region, shape (h, w).
    """
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((7, 7), np.uint8))
    outlines, _ = cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    hull = cv2.contourArea(cv2.convexHull(np.vstack(outlines)))
    return sum(cv2.contourArea(outline) for outline in outlines) / hull if hull > 0.0 else 1.0
