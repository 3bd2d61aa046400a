"""The pipe that is grasped and cut, and the other numbers of `workcell.yaml`."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.yaml_files import package_yaml

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pipe:
    """A straight pipe, in the world frame, in m.

    Attributes:
        point: Its middle, shape (3,).
        axis: Unit vector along it, shape (3,).
        radius: Outer radius.
        length: From end to end.
    """

    point: Array
    axis: Array
    radius: float
    length: float

    def rotation(self) -> Array:
        """Rotation matrix whose third column is the axis, shape (3, 3)."""
        z = self.axis
        x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
        x /= np.linalg.norm(x)
        return np.column_stack([x, np.cross(z, x), z])

    def lowest(self) -> float:
        """Height of its lowest point in m."""
        up = float(abs(self.axis[2]))
        return float(self.point[2] - 0.5 * self.length * up - self.radius * np.sqrt(max(0.0, 1.0 - up**2)))

    def at(self, place: ArrayLike) -> "Pipe":
        """The same pipe with its middle and axis given one after the other, shape (6,)."""
        values = np.asarray(place, dtype=float)
        return replace(self, point=values[:3], axis=values[3:] / np.linalg.norm(values[3:]))

    def moved(self, rotation: ArrayLike, translation: ArrayLike) -> "Pipe":
        """The pipe turned about the origin and then shifted, by a matrix (3, 3) and a vector (3,)."""
        turn = np.asarray(rotation, dtype=float)
        return replace(
            self, point=turn @ self.point + np.asarray(translation, dtype=float), axis=turn @ self.axis
        )


def make_pipe(
    point: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    radius: float | None = None,
    length: float | None = None,
) -> Pipe:
    """A pipe; what is not given is that of `workcell.yaml`.

    Raises:
        InputError: Wrong shapes, an axis without length, a radius or length that is not positive.
    """
    values = workcell_entries()["pipe"]
    middle = np.asarray(values["point"] if point is None else point, dtype=float)
    along = np.asarray(values["axis"] if axis is None else axis, dtype=float)
    radius = float(values["radius"] if radius is None else radius)
    length = float(values["length"] if length is None else length)
    if middle.shape != (3,) or along.shape != (3,) or not np.isfinite([*middle, *along]).all():
        raise InputError(f"pipe at {middle.tolist()} along {along.tolist()}; give three numbers each, in m")
    norm = float(np.linalg.norm(along))
    if norm < 1e-9 or not (radius > 0.0 and length > 0.0):
        raise InputError(
            f"pipe along {along.tolist()} with radius {radius} m and length {length} m; use positive sizes"
        )
    return Pipe(middle, along / norm, radius, length)


@cache
def workcell_entries() -> dict[str, dict[str, Any]]:
    """Part -> name -> value of `workcell.yaml`."""
    data = package_yaml(__package__, "workcell.yaml")
    return {part: {name: entry["value"] for name, entry in entries.items()} for part, entries in data.items()}


def home_angles(side: str) -> Array:
    """Joints 1 to 7 of the safe posture that a task starts from, in rad, shape (7,)."""
    return np.radians(workcell_entries()["home"][f"{side}_deg"])
