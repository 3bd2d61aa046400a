"""A run's numbers per joint as a table on the terminal."""

from rich.table import Table

from hydrolek_drake.replay.display import display_factor, display_unit
from hydrolek_drake.runs.summary import JointSummary


def joint_table(joints: tuple[JointSummary, ...]) -> Table:
    """One row a joint: where it went, its highest pressure, time at the stops, movement at rest."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("joint", no_wrap=True)
    for title in ("start", "lowest", "highest", "end", "pressure [MPa]", "at stops [s]", "at rest"):
        table.add_column(title, justify="right", no_wrap=True)
    for joint in joints:
        factor, unit = display_factor(joint.unit), display_unit(joint.unit)
        positions = (joint.start, joint.lowest, joint.highest, joint.end)
        table.add_row(
            f"{joint.joint} [{unit}]",
            *(f"{round(factor * value, 2) + 0.0:.2f}" for value in positions),
            "-" if joint.pressure is None else f"{1e-6 * joint.pressure:.2f}",
            f"{joint.at_stops:.2f}",
            "-" if joint.rest_movement is None else f"{factor * joint.rest_movement:.4f}",
        )
    return table
