"""What a search for places found, as JSON."""

import math
from collections import Counter
from typing import Any

from hydrolek_drake.standing.answer import Answer
from hydrolek_drake.standing.base import Placement
from hydrolek_drake.standing.reach import Stage
from hydrolek_drake.standing.site import Site


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


def _placed(placement: Placement) -> dict[str, Any]:
    return {
        "x": round(placement.x, 4),
        "y": round(placement.y, 4),
        "heading_deg": round(math.degrees(placement.heading), 3),
        "boom_deg": round(math.degrees(placement.boom), 3),
        "plate_height": round(placement.plate_height(), 4),
    }
