"""The replay on the terminal."""

from rich.table import Table

from hydrolek_drake.replay.comparison import Comparison, times_of
from hydrolek_drake.replay.display import display_factor, display_unit


def signal_table(comparisons: tuple[Comparison, ...]) -> Table:
    """One row per signal: how far apart, against the noise, and where it is worst."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("signal", no_wrap=True)
    for title in ("rms", "noise", "rms/noise", "mean", "largest"):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("worst stretch", no_wrap=True)
    for c in comparisons:
        factor, unit = display_factor(c.unit), display_unit(c.unit)
        if not c.samples:
            table.add_row(f"{c.key} \\[{unit}]", "nothing could be compared")
            continue
        worst = c.spans[0] if c.spans else None
        table.add_row(
            f"{c.key} \\[{unit}]",
            f"{factor * c.rms:.3g}",
            f"{factor * c.noise:.3g}",
            times_of(c.rms_over_noise).removesuffix(" times").replace("more than ", ">"),
            f"{factor * c.mean:.3g}",
            f"{factor * c.largest:.3g}",
            f"{worst.start:.2f}-{worst.end:.2f} s" if worst else "none",
        )
    return table
