"""What the machine is placed for: a pipe with the places to grasp and cut, and what stands around; as data."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.workcell.pipe import Pipe, make_pipe
from hydrolek_drake.workcell.surroundings import Block
from hydrolek_drake.yaml_files import read_yaml

Array = NDArray[np.float64]

FLOOR = Block("floor", np.array([0.0, 0.0, -0.5]), np.array([40.0, 40.0, 1.0]))
"""Which the arms must not touch; its upper face is the site's z = 0."""

_GRASP, _CUT = -0.05, 0.12  # m along the pipe from its middle, where nothing else is said
_PARTS = ("pipe", "grasp", "cut", "blocks")
_PIPE = ("point", "axis", "radius", "length")
_BLOCK = ("name", "middle", "size", "heading_deg")
_TAKEN = ("world", "plate", "floor", "brokk", "right", "left")
"""How the names of what is there already begin."""
_MOST_BLOCKS = 100
FARTHEST = 100.0  # m: what is farther or larger is a mistake


@dataclass(frozen=True)
class Site:
    """A pipe and what stands around, in the site frame, lengths in m.

    Attributes:
        pipe: To be grasped and cut.
        grasp: Where, along the axis from the pipe's middle.
        cut: Likewise.
        blocks: What must not be touched, without the floor.
    """

    pipe: Pipe
    grasp: float
    cut: float
    blocks: tuple[Block, ...] = ()

    def __post_init__(self) -> None:
        lengths = [*self.pipe.point, self.pipe.radius, self.pipe.length]
        for block in self.blocks:
            lengths += [*block.middle, *block.size]
        if not all(abs(length) <= FARTHEST for length in lengths):
            raise InputError(f"a length or place of the site is beyond {FARTHEST:g} m; give metres")
        for name, along in (("grasp", self.grasp), ("cut", self.cut)):
            if not abs(along) <= 0.5 * self.pipe.length:
                raise InputError(
                    f"the {name} at {along:g} m from the pipe's middle is beyond its end; the pipe is "
                    f"{self.pipe.length:g} m long"
                )
        if self.grasp == self.cut:
            raise InputError(
                f"grasp and cut are both at {self.cut:g} m; the pipe cannot be cut where it is held"
            )
        if self.pipe.lowest() < 0.0:
            raise InputError(
                f"the pipe reaches {-self.pipe.lowest():.3g} m into the floor; z is upwards from the floor"
            )

    def grasp_point(self) -> Array:
        """On the pipe's axis, shape (3,)."""
        return np.asarray(self.pipe.point + self.grasp * self.pipe.axis)

    def cut_point(self) -> Array:
        """On the pipe's axis, shape (3,)."""
        return np.asarray(self.pipe.point + self.cut * self.pipe.axis)

    def mirrored(self) -> "Site":
        """Its mirror image in the plane y = 0."""
        flip = np.array([1.0, -1.0, 1.0])
        pipe = make_pipe(flip * self.pipe.point, flip * self.pipe.axis, self.pipe.radius, self.pipe.length)
        blocks = tuple(Block(each.name, flip * each.middle, each.size, -each.heading) for each in self.blocks)
        return Site(pipe, self.grasp, self.cut, blocks)


def make_site(parts: dict[str, Any], where: str = "") -> Site:
    """A site of parts as `read_site` gives them; what is missing is the workcell's pipe and the places below.

    Args:
        parts: Of it.
        where: They come from, for errors.

    Raises:
        InputError: They do not make a site.
    """
    try:
        pipe = make_pipe(**parts.get("pipe", {}))
        return Site(pipe, parts.get("grasp", _GRASP), parts.get("cut", _CUT), parts.get("blocks", ()))
    except InputError as error:
        raise InputError(f"{where}: {error}" if where else str(error)) from None


def read_site(path: Path) -> dict[str, Any]:
    """Parts of a site that a file gives, checked: `pipe` (arguments of `make_pipe`), `grasp`, `cut`, `blocks`.

    ```yaml
    pipe: {point: [1.87, 0, 1.06], axis: [0, 0, 1], radius: 0.0375, length: 1.2}   # m, site frame
    grasp: -0.05                                                                    # m along the axis from its middle
    cut: 0.12
    blocks: [{name: bench, middle: [1.5, 0, 0.3], size: [0.5, 1.0, 0.6], heading_deg: 10}]
    ```

    Raises:
        InputError: It cannot be read, or a part is unknown, missing or of another form.
    """
    data = read_yaml(path, "site file")
    found = _mapping(data, f"{path}", _PARTS)
    parts: dict[str, Any] = {}
    if "pipe" in found:
        given = _mapping(found["pipe"], f"{path}: pipe", _PIPE)
        parts["pipe"] = {
            name: (_vector if name in ("point", "axis") else _number)(value, f"{path}: pipe.{name}")
            for name, value in given.items()
        }  # fmt: skip
    for name in ("grasp", "cut"):
        if name in found:
            parts[name] = _number(found[name], f"{path}: {name}")
    blocks = found.get("blocks", [])
    if not isinstance(blocks, list) or len(blocks) > _MOST_BLOCKS:
        raise InputError(f"{path}: blocks must be a list of at most {_MOST_BLOCKS}")
    parts["blocks"] = tuple(_block(each, f"{path}: blocks[{index}]") for index, each in enumerate(blocks))
    names = [block.name for block in parts["blocks"]]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{path}: two blocks are called '{name}'; give each a name of its own")
    return parts


def _block(data: Any, where: str) -> Block:
    entry = _mapping(data, where, _BLOCK)
    for name in _BLOCK[:3]:
        if name not in entry:
            raise InputError(
                f"{where}: {name} is missing; give name, middle, size, and heading_deg if it is turned"
            )
    name = entry["name"]
    if (
        not isinstance(name, str)
        or not name.isprintable()
        or not 0 < len(name.strip()) <= len(name) <= 40
        or name.startswith(_TAKEN)
    ):
        raise InputError(
            f"{where}: give a name of at most 40 letters that does not begin with {', '.join(_TAKEN)}"
        )
    size = _vector(entry["size"], f"{where}: size")
    if not np.all(size > 0.0):
        raise InputError(f"{where}: size is {size.tolist()}; give three positive lengths in m")
    heading = math.radians(_number(entry.get("heading_deg", 0.0), f"{where}: heading_deg"))
    return Block(name, _vector(entry["middle"], f"{where}: middle"), size, heading)


def _mapping(data: Any, where: str, names: tuple[str, ...]) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise InputError(f"{where}: give {', '.join(names)}")
    for name in data:
        if name not in names:
            raise InputError(f"{where}: '{str(name)[:40]}' is unknown; choose from {', '.join(names)}")
    return data


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise InputError(f"{where} is {str(value)[:40]}; give a finite number")
    return float(value)


def _vector(value: Any, where: str) -> Array:
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f"{where} is {str(value)[:60]}; give three numbers")
    return np.array([_number(each, where) for each in value])
