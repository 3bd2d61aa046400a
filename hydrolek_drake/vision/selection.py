"""The object that the operator clicks on: thesis section 5.2.4, and the same from surfaces."""

from dataclasses import dataclass
from enum import Enum

import cv2
import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.edges import dilated
from hydrolek_drake.vision.surfaces import Surfaces

Mask = NDArray[np.bool_]

_RED = (0, 0, 255)  # blue, green, red
_BESIDE = 9  # px: pieces this near to each other may belong together
_FLUSH = 0.004  # m: noise of the step from one piece to the next
_SPLINTER = 0.05  # of the other's area: a piece this small is part of it
_LESS = 0.02  # of convexity that joining a piece may cost


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
    """

    colour: NDArray[np.uint8]
    mask: Mask
    edges: NDArray[np.uint8]
    surfaces: Surfaces


def select_object(snapshot: Snapshot, pixel: tuple[float, float], fill: Fill = Fill.SURFACES) -> Mask:
    """The object around a click.

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
    if fill is Fill.EDGES:
        return fill_between_lines(snapshot.edges, snapshot.mask, (u, v))
    piece = _piece_at(snapshot.surfaces.pieces, u, v)
    if piece == 0:
        if not snapshot.mask[v, u]:
            raise InputError(_nothing(u, v))
        if not snapshot.surfaces.standing_out[v, u]:
            raise InputError(
                f"the click at ({u}, {v}) is on a wall, floor or table, not on an object that stands out of it"
            )
        raise InputError(
            f"the click at ({u}, {v}) is between objects; click further inside, or fill up to the lines instead"
        )
    return _joined(snapshot.surfaces, piece)


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


def _joined(surfaces: Surfaces, piece: int) -> Mask:
    """A piece with those around it that make one convex object with it, such as a cup's inside.

    Two pieces belong together if together they fill their hull as well as each alone, unless the one in front
    bites into the other: then it stands before it or on it.
    """
    values = kinect_entries("surfaces")
    selected = surfaces.pieces == piece
    tried = {0, piece}
    while True:
        near = cv2.dilate(selected.astype(np.uint8), np.ones((_BESIDE, _BESIDE), np.uint8)).astype(bool)
        numbers, counts = np.unique(surfaces.pieces[near], return_counts=True)
        others = [int(n) for n in numbers[np.argsort(-counts)] if int(n) not in tried]
        if not others:
            return _without_holes(selected)
        for other in others:
            tried.add(other)
            candidate = surfaces.pieces == other
            if _one_object(surfaces.depth, selected, candidate, values["convexity"]):
                selected = selected | candidate
                tried = {0, *np.unique(surfaces.pieces[selected]).tolist()}
                break


def _one_object(depth: NDArray[np.float32], a: Mask, b: Mask, least: float) -> bool:
    area_a, area_b = int(a.sum()), int(b.sum())
    convex_a, convex_b, together = _convexity(a), _convexity(b), _convexity(a | b)
    mean = (area_a * convex_a + area_b * convex_b) / (area_a + area_b)
    if together < min(least, max(convex_a, convex_b)) - _LESS or together < mean - _LESS:
        return False
    rounder, bitten = (a, b) if convex_a >= convex_b else (b, a)
    return _step(depth, rounder, bitten) > -_FLUSH or min(area_a, area_b) < _SPLINTER * max(area_a, area_b)


def _step(depth: NDArray[np.float32], a: Mask, b: Mask) -> float:
    """Median depth of `a` less that of `b` where they border, in m."""
    kernel = np.ones((_BESIDE, _BESIDE), np.uint8)
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


def _without_holes(mask: Mask) -> Mask:
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    outlines, _ = cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    filled = np.zeros_like(closed)
    cv2.drawContours(filled, outlines, -1, 1, cv2.FILLED)
    return filled.astype(bool)
