"""Normals and concave creases of a depth picture, compiled.

In inverse depth w = 1/Z a plane is a linear function of the pixel, whatever its slope, and a Kinect's noise is
even. A normal is therefore a linear regression of w in a small window; n ~ (f w_u, f w_v, w - x f w_u - y f w_v)
with x, y the ray's slopes.
"""

import math
from typing import Any

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def normals(sums: Any, least: float, rays: Any, focal: Any, normal: Any, point: Any) -> None:
    """Normals and smoothed points from the moments of a window around each pixel.

    Args:
        sums: Sums over the window of 1, du, dv, du^2, dv^2, du dv, w, du w, dv w over valid pixels, with du and
            dv the distances from the middle in px of the full picture; shape (9, h, w).
        least: Number of valid pixels that a window needs.
        rays: Slopes x, y of the rays, shape (2, h, w).
        focal: Focal lengths in px of the full picture, shape (2,).
        normal: Receives unit normals towards the camera, shape (h, w, 3); zeros where there is none.
        point: Receives the points in m, shape (h, w, 3).
    """
    for row in range(sums.shape[1]):
        for column in range(sums.shape[2]):
            for axis in range(3):
                normal[row, column, axis] = 0.0
                point[row, column, axis] = 0.0
            n = sums[0, row, column]
            if n < least:
                continue
            u, v, w = sums[1, row, column] / n, sums[2, row, column] / n, sums[6, row, column] / n
            uu, vv = sums[3, row, column] - n * u * u, sums[4, row, column] - n * v * v
            uv = sums[5, row, column] - n * u * v
            uw, vw = sums[7, row, column] - n * u * w, sums[8, row, column] - n * v * w
            determinant = uu * vv - uv * uv
            if determinant < 1.0:
                continue
            w_u, w_v = (uw * vv - vw * uv) / determinant, (vw * uu - uw * uv) / determinant
            middle = w - w_u * u - w_v * v
            if middle <= 0.0:
                continue
            x, y = rays[0, row, column], rays[1, row, column]
            a, b = focal[0] * w_u, focal[1] * w_v
            c = middle - x * a - y * b
            length = -math.sqrt(a * a + b * b + c * c)
            normal[row, column, 0], normal[row, column, 1] = a / length, b / length
            normal[row, column, 2] = c / length
            point[row, column, 0], point[row, column, 1] = x / middle, y / middle
            point[row, column, 2] = 1.0 / middle


@njit(cache=True, nogil=True)
def creases(normal: Any, point: Any, apart: int, farthest: float, crease: Any) -> None:
    """1 - cos of the angle between the normals on both sides, where the surface is concave there.

    Args:
        normal: Unit normals towards the camera, shape (h, w, 3).
        point: Points in m, shape (h, w, 3).
        apart: Distance in px to either side.
        farthest: Difference in depth in m beyond which both sides are not one surface.
        crease: Receives the larger of both directions, 0 where convex or unknown; shape (h, w).
    """
    height, width = crease.shape
    crease[:] = 0.0
    for row in range(height):
        for column in range(width):
            for way in range(2):
                down, right = (apart, 0) if way == 0 else (0, apart)
                r0, r1, c0, c1 = row - down, row + down, column - right, column + right
                if r0 < 0 or c0 < 0 or r1 >= height or c1 >= width:
                    continue
                z0, z1 = point[r0, c0, 2], point[r1, c1, 2]
                if z0 == 0.0 or z1 == 0.0 or abs(z1 - z0) > farthest:
                    continue
                spread, cosine = 0.0, 0.0
                for axis in range(3):
                    spread += (normal[r1, c1, axis] - normal[r0, c0, axis]) * (
                        point[r1, c1, axis] - point[r0, c0, axis]
                    )
                    cosine += normal[r1, c1, axis] * normal[r0, c0, axis]
                if spread < 0.0:
                    crease[row, column] = max(crease[row, column], 1.0 - cosine)


@njit(cache=True, nogil=True)
def inliers(planes: Any, rays: Any, inverse_depth: Any, tolerance: float, counts: Any) -> None:
    """How many samples lie on each plane a x + b y + c = w, within `tolerance`.

    Args:
        planes: a, b, c, shape (n, 3).
        rays: x and y of the samples, shape (2, m).
        inverse_depth: w of the samples in 1/m, shape (m,).
        tolerance: In 1/m.
        counts: Receives the numbers, shape (n,).
    """
    for index in range(planes.shape[0]):
        a, b, c = planes[index, 0], planes[index, 1], planes[index, 2]
        count = 0
        for sample in range(len(inverse_depth)):
            if abs(a * rays[0, sample] + b * rays[1, sample] + c - inverse_depth[sample]) < tolerance:
                count += 1
        counts[index] = count


@njit(cache=True, nogil=True)
def least_height(depth: Any, rays: Any, planes: Any, height: Any) -> None:
    """Height of each point over the plane that it is least above, in m; 0 where there is no depth.

    Args:
        depth: In m, shape (h, w).
        rays: Slopes of the rays, across (w,) and down (h,), one after the other in one array (w + h,).
        planes: a, b, c with a X + b Y + c Z = 1, shape (n, 3); the camera is on their positive side.
        height: Receives the heights, infinite where there is no plane; shape (h, w).
    """
    rows, columns = depth.shape
    for row in range(rows):
        for column in range(columns):
            z = depth[row, column]
            if z == 0.0:
                height[row, column] = 0.0
                continue
            least = np.inf
            for index in range(planes.shape[0]):
                a, b, c = planes[index, 0], planes[index, 1], planes[index, 2]
                norm = math.sqrt(a * a + b * b + c * c)
                above = (1.0 - z * (a * rays[column] + b * rays[columns + row] + c)) / norm
                least = min(least, above)
            height[row, column] = least


@njit(cache=True, nogil=True)
def grow(labels: Any, allowed: Any, smallest: int, reach: int) -> None:
    """Drop small regions, number the others anew, and spread them over the allowed pixels around them.

    Args:
        labels: Numbers of regions, 0 for none, changed in place; shape (h, w).
        allowed: Not 0 where a number may spread to, shape (h, w).
        smallest: In px; smaller regions are dropped.
        reach: How far at most, in px, counted along rows and columns.
    """
    height, width = labels.shape
    most = 0
    for row in range(height):
        for column in range(width):
            most = max(most, labels[row, column])
    size = np.zeros(most + 1, np.int64)
    for row in range(height):
        for column in range(width):
            size[labels[row, column]] += 1
    number = np.zeros(most + 1, np.int32)
    count = 0
    for label in range(1, most + 1):
        if size[label] >= smallest:
            count += 1
            number[label] = count
    front = np.empty(height * width, np.int64)
    end = 0
    for row in range(height):
        for column in range(width):
            if labels[row, column] == 0:
                continue
            labels[row, column] = number[labels[row, column]]
            if labels[row, column] > 0:
                front[end] = row * width + column
                end += 1
    begin = 0
    for _ in range(reach):
        stop = end
        for index in range(begin, stop):
            row, column = front[index] // width, front[index] % width
            for way in range(4):
                r = row + (1 if way == 0 else -1 if way == 1 else 0)
                c = column + (1 if way == 2 else -1 if way == 3 else 0)
                if 0 <= r < height and 0 <= c < width and labels[r, c] == 0 and allowed[r, c] != 0:
                    labels[r, c] = labels[row, column]
                    front[end] = r * width + c
                    end += 1
        begin = stop
