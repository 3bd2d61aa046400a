"""Pictures of where to stand: the map from above with the best place, and the arms there from the side."""

import io
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.kinematics.forward import joint_positions
from hydrolek_drake.kinematics.frames import fixed_pose
from hydrolek_drake.standing.answer import Answer, MapPoint, Standing
from hydrolek_drake.standing.base import Placement
from hydrolek_drake.standing.clearance import base_boxes
from hydrolek_drake.standing.reach import Stage
from hydrolek_drake.standing.site import Site
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.workcell.pipe import Pipe

Array = NDArray[np.float64]

_ARMS = {"right": "#c0392b", "left": "#1f5fa8"}
_PIPE, _BLOCK, _BASE = "#444444", "#b9a27c", "#e0b400"


def standing_png(site: Site, answer: Answer) -> bytes:
    """Map of places from above, and the machine at the best one from above and from its side.

    Args:
        site: Pipe and blocks.
        answer: What was found; without a place the map alone is drawn.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13.0, 6.6 if answer.standings else 7.0), layout="constrained")
    axes: Any = figure.subplots(1, 2, squeeze=False)[0] if answer.standings else [figure.subplots()]
    _draw_map(figure, axes[0], site, answer)
    if answer.standings:
        _draw_side(axes[1], site, answer.standings[0])
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()


def _draw_map(figure: Any, axis: Any, site: Site, answer: Answer) -> None:
    best: dict[tuple[float, float], MapPoint] = {}
    for point in answer.points:
        place = (round(point.placement.x, 3), round(point.placement.y, 3))
        known = best.get(place)
        if known is None or (point.stage, point.margin) > (known.stage, known.margin):
            best[place] = point
    short = [point.placement for point in best.values() if point.stage is not Stage.REACHED]
    good = sorted((p for p in best.values() if p.stage is Stage.REACHED), key=lambda p: p.margin)
    axis.plot(
        [p.x for p in short],
        [p.y for p in short],
        ".",
        color="#dddddd",
        markersize=2.5,
        zorder=0,
        label="out of reach",
    )
    if good:
        marks = axis.scatter(
            [p.placement.x for p in good], [p.placement.y for p in good],
            c=[math.degrees(p.margin) for p in good], cmap="viridis", s=20, vmin=0.0, zorder=1, label="within reach",
        )  # fmt: skip
        figure.colorbar(marks, ax=axis, label="margin of the joints by kinematics alone [deg]", shrink=0.8)
    for block in site.blocks:
        _outline(axis, block.pose().GetAsMatrix4(), block.size, (0, 1), _BLOCK, label=block.name)
    for number, standing in enumerate(answer.standings[::-1]):
        first = number == len(answer.standings) - 1
        _draw_machine(axis, standing, (0, 1), faint=not first)
        x, y = standing.placement.x, standing.placement.y
        back = -0.72 * np.array([math.cos(standing.placement.heading), math.sin(standing.placement.heading)])
        axis.annotate(
            str(len(answer.standings) - number), (x + back[0], y + back[1]), ha="center", va="center",
            fontsize=10, fontweight="bold", bbox={"boxstyle": "circle", "fc": "white", "ec": _BASE},
        )  # fmt: skip
    _draw_pipe(axis, site, (0, 1))
    axis.plot(0.0, 0.0, "+", color="black", markersize=10, label="stands now")
    axis.set(xlabel="x of the base [m], forward", ylabel="y [m], to the left", title="from above")
    axis.set_aspect("equal")
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.09), ncols=4, fontsize=8)


def _draw_side(axis: Any, site: Site, standing: Standing) -> None:
    """In the machine's own plane: forward and up, heights above the floor."""
    placement = standing.placement
    turned = Site(_pipe_from_base(placement, site), site.grasp, site.cut)
    own = Standing(
        Placement(0.0, 0.0, 0.0, placement.boom),
        standing.grasping,
        standing.margins,
        standing.plan,
        standing.plan_margin,
    )
    _draw_machine(axis, own, (0, 2))
    _draw_pipe(axis, turned, (0, 2))
    for block in site.blocks:
        moved = block.moved(0.0, [-placement.x, -placement.y, 0.0]).moved(-placement.heading, np.zeros(3))
        _outline(axis, moved.pose().GetAsMatrix4(), block.size, (0, 2), _BLOCK)
    axis.axhline(0.0, color="black", linewidth=1.0)
    margins = standing.margins
    axis.set(
        xlabel="forward of the base [m]", ylabel="above the floor [m]",
        title=f"place 1: {margins.joint_name} comes to {math.degrees(margins.joint):.1f} deg from its stop,\narms to "
        f"{1e3 * margins.clearance:.0f} mm from anything",
    )  # fmt: skip
    axis.set_aspect("equal")
    axis.legend(loc="upper left", fontsize=8)


def _pipe_from_base(placement: Placement, site: Site) -> Pipe:
    """The site's pipe as seen from the base's frame on the floor."""
    c, s = math.cos(placement.heading), math.sin(placement.heading)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return site.pipe.moved(turn, -turn @ np.array([placement.x, placement.y, 0.0]))


def _draw_machine(axis: Any, standing: Standing, plane: tuple[int, int], faint: bool = False) -> None:
    placement = standing.placement
    turn, origin = placement.machine_in_site()
    base = np.eye(4)
    base[:3, :3], base[:3, 3] = turn, [placement.x, placement.y, 0.0]
    for pose, size in base_boxes(placement.boom):
        _outline(axis, base @ pose.GetAsMatrix4(), size, plane, _BASE, alpha=0.25 if faint else 0.9)
    if faint:
        return
    shown = {standing.grasping: standing.plan.grasp.angles[-1]}
    assert standing.plan.cut is not None  # a task that grasps and cuts
    cut = standing.plan.cut
    shown[cut.side] = cut.angles[len(cut.angles) // 2]
    for side in SIDES:
        pose = fixed_pose("world", f"{side}_base")
        points = (joint_positions(shown[side]) @ pose[:3, :3].T + pose[:3, 3]) @ turn.T + origin
        role = "grasps" if side == standing.grasping else "cuts"
        axis.plot(
            points[:, plane[0]], points[:, plane[1]], "o-", color=_ARMS[side], linewidth=2.5, markersize=3.5,
            label=f"{side} arm {role}",
        )  # fmt: skip
        if role == "cuts":
            blade = points[-1] + kinect_entries("targets")["blade_reach"] * (turn @ cut.direction)
            ends = np.array([points[-1], blade])
            axis.plot(ends[:, plane[0]], ends[:, plane[1]], ":", color=_ARMS[side], linewidth=2.0)


def _draw_pipe(axis: Any, site: Site, plane: tuple[int, int]) -> None:
    pipe = site.pipe
    first, last = plane
    ends = np.array([pipe.point + sign * 0.5 * pipe.length * pipe.axis for sign in (-1.0, 1.0)])
    if np.linalg.norm((ends[1] - ends[0])[list(plane)]) < pipe.radius:
        from matplotlib.patches import Circle

        axis.add_patch(Circle((pipe.point[first], pipe.point[last]), pipe.radius, color=_PIPE, zorder=5))
    else:
        axis.plot(ends[:, first], ends[:, last], color=_PIPE, linewidth=5, solid_capstyle="butt", alpha=0.7)
    for name, point, mark in (("grasp", site.grasp_point(), "s"), ("cut", site.cut_point(), "X")):
        axis.plot(
            point[first], point[last], mark, color="white", markeredgecolor="black", markersize=8, zorder=6,
            label=f"{name}", linestyle="none",
        )  # fmt: skip


def _outline(
    axis: Any,
    pose: Array,
    size: Array,
    plane: tuple[int, int],
    colour: str,
    *,
    alpha: float = 0.7,
    label: str | None = None,
) -> None:
    """Silhouette of a box: the convex hull of its corners in a plane."""
    from matplotlib.patches import Polygon
    from scipy.spatial import ConvexHull

    corners = 0.5 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size
    flat = (corners @ pose[:3, :3].T + pose[:3, 3])[:, list(plane)]
    hull = flat[ConvexHull(flat).vertices]
    axis.add_patch(
        Polygon(hull, facecolor=colour, edgecolor="#555555", linewidth=0.6, alpha=alpha, label=label)
    )
