"""What a search for places found, as JSON, and a place read back from it."""

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.standing.base import Placement
from hydrolek_drake.standing.reach import Stage
from hydrolek_drake.standing.search import Answer
from hydrolek_drake.standing.site import Site
from hydrolek_drake.workcell.pipe import Pipe, make_pipe

_LARGEST = 10_000_000  # bytes; a map has some 2 MB


def answer_json(site: Site, answer: Answer) -> dict[str, Any]:
    """Places, best first; the map; the reason where there is none. Lengths in m, angles in degrees."""
    count = Counter(point.stage for point in answer.points)
    return {
        "pipe": {
            "point": site.pipe.point.tolist(),
            "axis": site.pipe.axis.tolist(),
            "radius": site.pipe.radius,
            "length": site.pipe.length,
        },
        "grasp": site.grasp,
        "cut": site.cut,
        "places": [
            _placed(each.placement)
            | {
                "grasping": each.grasping,
                "joint_margin_deg": math.degrees(each.margins.joint),
                "joint": each.margins.joint_name,
                "clearance_m": each.margins.clearance,
                "base_clearance_m": each.margins.base,
                "score": each.margins.score,
                "joint_margin_of_whole_task_deg": math.degrees(each.plan_margin),
                "task_s": each.plan.duration(),
            }
            for each in answer.standings
        ],
        "reason": answer.reason,
        "map_stages": {stage.name.lower(): count[stage] for stage in Stage if count[stage]},
        "map": [
            _placed(point.placement)
            | {"grasping": point.grasping, "joint_margin_deg": round(math.degrees(point.margin), 3)}
            for point in answer.points
            if point.stage is Stage.REACHED
        ],
    }


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
    return Placement(x, y, math.radians(heading), math.radians(boom)), make_pipe(point, axis, radius, length)


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not math.isfinite(float(value)) or isinstance(value, str):
        raise ValueError
    return float(value)


def _placed(placement: Placement) -> dict[str, Any]:
    return {
        "x": round(placement.x, 4),
        "y": round(placement.y, 4),
        "heading_deg": round(math.degrees(placement.heading), 3),
        "boom_deg": round(math.degrees(placement.boom), 3),
        "plate_height": round(placement.plate_height(), 4),
    }
