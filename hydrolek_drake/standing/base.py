"""Where tracks and boom can bring the shoulder plate: ranges, and the plate's pose for a placement."""

import math
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.units import si_factor
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.surroundings import Block, Surroundings, boom_pins
from hydrolek_drake.yaml_files import package_yaml, read_yaml

Array = NDArray[np.float64]
Range = tuple[float, float]

_SI = {
    "tracks": {"x": "m", "y": "m", "heading": "rad", "keep": "m"},
    "boom": {"angle": "rad"},
    "wanted": {"joint_margin": "rad", "clearance": "m"},
    "search": {
        "distance_step": "m", "heading_step": "rad", "boom_step": "rad", "rounds": "", "refined": "",
        "apart": "m", "looked_at": "",
    },
}  # fmt: skip
"""Part -> name -> SI unit of `base.yaml`; what is a range has two values, the lower first."""
_RANGES = (("tracks", "x"), ("tracks", "y"), ("tracks", "heading"), ("boom", "angle"))
_WITHIN = {
    "distance_step": (0.01, 1.0),
    "heading_step": (math.radians(1.0), math.tau),
    "boom_step": (math.radians(1.0), math.pi),
    "rounds": (0, 10),
    "refined": (1, 100),
    "looked_at": (1, 100_000),
    "apart": (0.0, 10.0),
}
"""What a search can be set to, in SI: beyond, it would take forever or see nothing."""
_STEEP = math.pi / 2  # rad: a boom beyond the vertical would lean back over the base
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Placement:
    """Where the machine stands, in the site frame (x forward, y left, z up, origin on the floor).

    Attributes:
        x: Of the origin of the base's frame, in m.
        y: Likewise.
        heading: Of the base, rad to the left.
        boom: Angle of the line between the boom's pins above the level, in rad.
    """

    x: float
    y: float
    heading: float
    boom: float

    def plate_shift(self) -> tuple[float, float]:
        """How far forward and up the plate is from where the URDF draws it, in m.

        The plate is kept level and moves with the boom's pin, which turns about its pivot.
        """
        pivot, pin = boom_pins()
        length, drawn = math.hypot(pin[0] - pivot[0], pin[2] - pivot[2]), drawn_boom_angle()
        return (
            length * (math.cos(self.boom) - math.cos(drawn)),
            length * (math.sin(self.boom) - math.sin(drawn)),
        )

    def machine_in_site(self) -> tuple[Array, Array]:
        """Rotation (3, 3) and position in m (3,) of the arms' world frame, which moves with the plate."""
        c, s = math.cos(self.heading), math.sin(self.heading)
        forward, up = self.plate_shift()
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return turn, np.array([self.x + c * forward, self.y + s * forward, up])

    def point_seen(self, point: ArrayLike) -> Array:
        """A point of the site, shape (3,), in the arms' world frame, in m."""
        turn, origin = self.machine_in_site()
        return turn.T @ (np.asarray(point, dtype=float) - origin)

    def pipe_seen(self, pipe: Pipe) -> Pipe:
        """A pipe of the site in the arms' world frame."""
        turn, origin = self.machine_in_site()
        return pipe.moved(turn.T, -turn.T @ origin)

    def surroundings(self, blocks: tuple[Block, ...]) -> Surroundings:
        """Blocks of the site in the arms' world frame, and the base under the plate."""
        turn, origin = self.machine_in_site()
        seen = tuple(block.moved(-self.heading, -turn.T @ origin) for block in blocks)
        return Surroundings(seen, self.plate_shift(), self.boom - drawn_boom_angle())

    def mirrored(self) -> "Placement":
        """Its mirror image in the plane y = 0 of the site."""
        return replace(self, y=-self.y, heading=-self.heading)

    def plate_height(self) -> float:
        """Height of the shoulder plate's upper face above the floor in m."""
        from hydrolek_drake.kinematics.frames import fixed_pose

        return float(fixed_pose("world", "plate")[2, 3]) + self.plate_shift()[1]


@cache
def drawn_boom_angle() -> float:
    """Angle in rad at which the URDF draws the boom."""
    pivot, pin = boom_pins()
    return math.atan2(pin[2] - pivot[2], pin[0] - pivot[0])


@dataclass(frozen=True)
class Base:
    """What tracks and boom can do, and how places are searched and weighed; all in SI.

    Attributes:
        x: Range of the tracks in m.
        y: Likewise.
        heading: Range in rad.
        boom: Range of the boom's angle in rad.
        keep: Distance in m of base and boom from everything.
        joint_margin: Wanted angle in rad between any joint and its stops.
        clearance: Wanted distance in m between an arm and anything else.
        search: Name -> value of the search's settings.
    """

    x: Range
    y: Range
    heading: Range
    boom: Range
    keep: float
    joint_margin: float
    clearance: float
    search: dict[str, float]

    def allows(self, placement: Placement) -> bool:
        """Whether a placement is within all ranges."""
        pairs = (
            (placement.x, self.x),
            (placement.y, self.y),
            (placement.boom, self.boom),
        )
        low, high = self.heading
        turned = (placement.heading - low) % math.tau
        around = turned <= high - low + _ROUNDING or turned >= math.tau - _ROUNDING
        return around and all(
            lower - _ROUNDING <= value <= upper + _ROUNDING for value, (lower, upper) in pairs
        )


def load_base(path: Path | None = None) -> Base:
    """The ranges of `base.yaml`, or of a file that is written like it and states all of it or a part.

    Raises:
        InputError: The file cannot be read, or an entry is unknown, no number, of another unit, or turned round.
    """
    values, where = _values(package_yaml(__package__, "base.yaml"), "base.yaml"), str(path or "base.yaml")
    if path is not None:
        for part, entries in _values(read_yaml(path, "base file"), str(path)).items():
            values[part] |= entries
    for part, name in _RANGES:
        low, high = values[part][name]
        if not low <= high:
            raise InputError(f"{where}: {part}.{name} is [{low:g}, {high:g}]; give the lower value first")
    for name in _SI["wanted"]:
        if not values["wanted"][name] > 0.0:
            raise InputError(f"{where}: wanted.{name} is {values['wanted'][name]:g}; give a positive number")
    for name, (low, high) in _WITHIN.items():
        if not low <= values["search"][name] <= high:
            raise InputError(
                f"{where}: search.{name} is {values['search'][name]:g} in SI; give {low:g} to {high:g}"
            )
    if not -_STEEP < values["boom"]["angle"][0] <= values["boom"]["angle"][1] < _STEEP:
        raise InputError(f"{where}: boom.angle must lie between -90 and 90 deg")
    tracks, wanted = values["tracks"], values["wanted"]
    return Base(
        tracks["x"], tracks["y"], tracks["heading"], values["boom"]["angle"], tracks["keep"],
        wanted["joint_margin"], wanted["clearance"], values["search"],
    )  # fmt: skip


def _values(data: Any, where: str) -> dict[str, dict[str, Any]]:
    if not isinstance(data, dict):
        raise InputError(f"{where}: give the parts {', '.join(_SI)}")
    found: dict[str, dict[str, Any]] = {}
    for part, entries in data.items():
        if part not in _SI or not isinstance(entries, dict):
            raise InputError(f"{where}: '{part}' is none of the parts {', '.join(_SI)} with entries")
        found[part] = {}
        for name, entry in entries.items():
            place = f"{where}: {part}.{name}"
            if name not in _SI[part]:
                raise InputError(f"{place} is unknown; choose from {', '.join(_SI[part])}")
            if not isinstance(entry, dict) or not {"value", "unit", "source"} >= set(entry) >= {
                "value",
                "unit",
            }:
                raise InputError(f"{place}: give value, unit and source")
            wanted = _SI[part][name]
            try:
                factor = si_factor(str(entry["unit"]), wanted) if wanted else 1.0
            except InputError as error:
                raise InputError(f"{place}: {error}") from None
            found[part][name] = _number(entry["value"], factor, place, pair=(part, name) in _RANGES)
    return found


def _number(value: Any, factor: float, place: str, *, pair: bool) -> Any:
    given = value if pair and isinstance(value, list) else [value]
    if len(given) != (2 if pair else 1) or not all(
        isinstance(each, (int, float)) and not isinstance(each, bool) and math.isfinite(each)
        for each in given
    ):
        raise InputError(f"{place}: value is {value}; give {'[lower, upper]' if pair else 'a finite number'}")
    numbers = [factor * float(each) for each in given]
    return (numbers[0], numbers[1]) if pair else numbers[0]
