"""The lever of a linkage as a table over the joint's angle."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter

KNOTS = 9
"""Angles at which the lever is given, evenly from the first to the last."""

PARAMETERS = (
    Parameter("first_position", "rad", "angle at the table's first lever"),
    Parameter("last_position", "rad", "angle at the table's last lever"),
    Parameter("first_stroke", "m", "stroke at the table's first lever"),
    *(
        Parameter(f"lever_{knot}", "m/rad", f"stroke over angle at knot {knot} of 0 to {KNOTS - 1}")
        for knot in range(KNOTS)
    ),
)


@njit
def _between(u: float, first: float, last: float) -> tuple[float, float]:
    """What a straight piece from one lever to the next adds at `u`, in pieces, and that integrated up to there."""
    passed = min(max(u, 0.0), 1.0)
    return (last - first) * passed, (last - first) * (0.5 * passed * passed + max(u - 1.0, 0.0))


@njit
def stroke_and_lever_of_table(position: float, joint: Any) -> tuple[float, float]:
    """Stroke [m] and lever ds/dq [m/rad] at an angle: the lever on straight lines, the stroke its integral.

    So both belong together at every angle, as virtual work asks. Beyond the table the lever stays.

    Args:
        position: of the joint [rad].
        joint: parameter record.
    """
    p = joint.linkage
    spacing = (p.last_position - p.first_position) / (KNOTS - 1)
    u = (position - p.first_position) / spacing
    rise_0, area_0 = _between(u, p.lever_0, p.lever_1)
    rise_1, area_1 = _between(u - 1.0, p.lever_1, p.lever_2)
    rise_2, area_2 = _between(u - 2.0, p.lever_2, p.lever_3)
    rise_3, area_3 = _between(u - 3.0, p.lever_3, p.lever_4)
    rise_4, area_4 = _between(u - 4.0, p.lever_4, p.lever_5)
    rise_5, area_5 = _between(u - 5.0, p.lever_5, p.lever_6)
    rise_6, area_6 = _between(u - 6.0, p.lever_6, p.lever_7)
    rise_7, area_7 = _between(u - 7.0, p.lever_7, p.lever_8)
    lever = p.lever_0 + rise_0 + rise_1 + rise_2 + rise_3 + rise_4 + rise_5 + rise_6 + rise_7
    areas = area_0 + area_1 + area_2 + area_3 + area_4 + area_5 + area_6 + area_7
    return p.first_stroke + spacing * (p.lever_0 * u + areas), lever
