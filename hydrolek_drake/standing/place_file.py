"""A place read back from the file that a search for places has left."""

import json
import math
from pathlib import Path
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.standing.base import Placement
from hydrolek_drake.standing.site import FARTHEST
from hydrolek_drake.workcell.pipe import Pipe, make_pipe

_UPRIGHT = 90.0  # deg
_LARGEST = 10_000_000  # bytes; a map has some 2 MB


def read_place(path: Path) -> tuple[Placement, Pipe]:
    """The best place of a `stand.json`, and the pipe in the site's frame.

    Raises:
        InputError: The file cannot be read, is another one, or holds no place.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(_LARGEST + 1)
        if len(data) > _LARGEST:
            raise InputError(f"{path} is larger than {_LARGEST // 1_000_000} MB, which no stand.json is")
        found = json.loads(data)
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(
            f"{path} cannot be read as a stand.json: {getattr(error, 'strerror', None) or error}"
        ) from None
    try:
        places, pipe = found["places"], found["pipe"]
        if not places:
            raise InputError(f"{path} holds no place: {str(found.get('reason', ''))[:200]}")
        first = places[0]
        numbers = [first["x"], first["y"], first["heading_deg"], first["boom_deg"]]
        x, y, heading, boom = (_finite(each) for each in numbers)
        radius, length = (_finite(pipe[name]) for name in ("radius", "length"))
        point, axis = ([_finite(each) for each in pipe[name]] for name in ("point", "axis"))
    except (KeyError, TypeError, IndexError, AttributeError, ValueError, OverflowError):
        raise InputError(f"{path} is no stand.json of `hydrolek stand --out`") from None
    try:
        there = make_pipe(point, axis, radius, length)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    if not max(abs(each) for each in (x, y, *point, radius, length)) <= FARTHEST or not abs(boom) < _UPRIGHT:
        raise InputError(f"{path}: places must be within {FARTHEST:g} m, the boom within {_UPRIGHT:g} deg")
    return Placement(x, y, math.radians(heading), math.radians(boom)), there


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not math.isfinite(float(value)) or isinstance(value, str):
        raise ValueError
    return float(value)
