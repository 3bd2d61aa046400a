"""The arm that a recording moved, as data for a drawing: links, shapes, joints, and their measured angles."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.report.packing import packed
from hydrolek_drake.identification.experiments.experiment import Experiment

DIGITS = 5
"""Of lengths [m] and turns."""


def arm_data(diagnosis: Diagnosis, shown: Sequence[Experiment]) -> dict[str, Any] | None:
    """The arm of the joints that are shown, on its base; None where a rig has none.

    Args:
        diagnosis: with a bench.
        shown: one experiment of each recording.

    Returns:
        `links` (parent's index, pose in it, axis that it turns about, joint, shapes), `posture` [rad] of joints that
        stand still, `joint` that is shown, and for each recording the measured angles [rad] of those that move.
    """
    from hydrolek_drake.kinematics.arms import arm_joint_names

    joint = shown[0].joint
    if joint not in arm_joint_names() or shown[0].channels[0].unit != "rad":
        return None
    from hydrolek_drake.visualization.urdf_tree import arms_tree

    assert diagnosis.bench is not None
    tree = arms_tree()
    side = joint.split("_")[0]
    other = next(name.split("_")[0] for name in tree.moving() if name.split("_")[0] != side)
    names = [tree.joints[0].parent]
    links: list[dict[str, Any]] = [{"parent": -1, "shapes": _shapes(tree.shapes[names[0]])}]
    for each in tree.joints:
        if other in each.child.split("_") or each.parent not in names:
            continue
        names.append(each.child)
        links.append(
            {
                "parent": names.index(each.parent),
                "origin": _pose(each.origin),
                "axis": None if each.axis is None else each.axis.tolist(),
                "joint": each.name,
                "shapes": _shapes(tree.shapes[each.child]),
            }
        )
    every = (*diagnosis.bench.training, *diagnosis.held_out)
    return {
        "joint": joint,
        "links": links,
        "posture": {k: v for k, v in diagnosis.rig.posture_without(joint).items() if k.startswith(side)},
        "recordings": [
            {
                e.joint: {"x": packed(e.time), "y": packed(e.channels[0].measured)}
                for e in every
                if e.name == recording.name and e.joint.startswith(side)
            }
            for recording in shown
        ],
    }


def _shapes(shapes: Sequence[Any]) -> list[dict[str, Any]]:
    return [
        {
            "kind": shape.kind,
            "size": list(shape.size),
            "pose": _pose(shape.pose),
            "colour": [round(255 * part) for part in shape.colour[:3]],
        }
        for shape in shapes
    ]


def _pose(pose: np.ndarray) -> list[float]:
    """The upper three rows of a homogeneous transform, row after row."""
    return [round(float(value), DIGITS) for value in pose[:3].ravel()]
