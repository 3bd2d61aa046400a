"""What a pipe stands on."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.workcell.pipe import Pipe, make_pipe, workcell_entries

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Table:
    """A level board, in the world frame, in m.

    Attributes:
        top: Middle of its upper face, shape (3,).
        size: Extent forward and sideways, shape (2,).
        thickness: Of the board.
    """

    top: Array
    size: Array
    thickness: float

    def lowered(self, by: float) -> "Table":
        """The same, lower."""
        return replace(self, top=self.top - [0.0, 0.0, by])

    def under(self, point: ArrayLike) -> bool:
        """Whether a point is above the board or on it, wherever its height."""
        offset = np.abs(np.asarray(point, dtype=float)[:2] - self.top[:2])
        return bool(np.all(offset <= 0.5 * self.size))


def make_table() -> Table:
    """The table of `workcell.yaml`."""
    values = workcell_entries()["table"]
    return Table(np.array(values["top"]), np.array(values["size"]), float(values["thickness"]))


def table_under(points: ArrayLike, height: float) -> Table:
    """What is taken to be the table where a camera has seen a level surface at a height.

    Args:
        points: What it reaches under, world frame, shape (n, 3); it goes on a while beyond.
        height: Of its upper face in m.
    """
    spread = np.asarray(points, dtype=float)[:, :2]
    low, high = spread.min(axis=0), spread.max(axis=0)
    size = high - low + 2.0 * workcell_entries()["place"]["beyond"]
    thickness = float(workcell_entries()["table"]["thickness"])
    return Table(np.array([*(0.5 * (low + high)), height]), size, thickness)


def make_loose_pipe(table: Table, *, point: ArrayLike | None = None) -> Pipe:
    """An upright pipe on the table.

    Args:
        table: What it stands on.
        point: Forward and sideways, shape (2,); that of the clamped pipe if not given.
    """
    values = workcell_entries()
    length = float(values["loose_pipe"]["length"])
    place = np.asarray(values["pipe"]["point"][:2] if point is None else point, dtype=float)
    return make_pipe([*place, table.top[2] + 0.5 * length], [0.0, 0.0, 1.0], length=length)
