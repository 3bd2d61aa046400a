"""Area of an edge over the spool's travel as a table: notches, then full ports."""

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter

KNOTS = ("quarter", "half", "three_quarters")
"""Of an edge's travel from its overlap to the full opening; at both ends stand none and all of the area."""


def parameters(edges: dict[str, str]) -> tuple[Parameter, ...]:
    """Shares of an edge's full area at the knots; neutral ones are a straight line.

    Args:
        edges: name -> what the edge connects.
    """
    return tuple(
        Parameter(
            f"share_{edge}_{knot}",
            "1",
            f"share of its full area that the edge {way} has open at {knot.replace('_', ' ')} of its travel",
            neutral=0.25 * (place + 1),
            lowest=0.0,
            highest=1.0,
        )
        for edge, way in edges.items()
        for place, knot in enumerate(KNOTS)
    )


@njit
def tabled(travelled: float, quarter: float, half: float, three_quarters: float) -> float:
    """Share of the full area at a share of the travel, on straight lines between the knots.

    Args:
        travelled: share of the travel, 0 to 1.
        quarter: share of the area at a quarter of it.
        half: at a half.
        three_quarters: at three quarters.
    """
    u = 4.0 * travelled
    return (
        quarter * min(u, 1.0)
        + (half - quarter) * min(max(u - 1.0, 0.0), 1.0)
        + (three_quarters - half) * min(max(u - 2.0, 0.0), 1.0)
        + (1.0 - three_quarters) * min(max(u - 3.0, 0.0), 1.0)
    )
