"""`hydrolek rigs`: the machines that are built in, and one machine's parameters."""

from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.settings import SeedOption, SetOption, parse_settings

if TYPE_CHECKING:
    from rich.table import Table

    from hydrolek_drake.rigs import Entry, Rig

_OFF = "neutral:"


def rigs(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="a built-in rig, or a rig file")
    ] = None,
    set_: SetOption = None,
    seed: SeedOption = None,
) -> None:
    """List the built-in rigs, or one rig's parameters with value, unit, range and source."""
    from hydrolek_drake.cli.output import console
    from hydrolek_drake.rigs import built_in_titles, load_rig

    out = console()
    if name is None:
        from rich.table import Table

        table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
        table.add_column("name", no_wrap=True)
        table.add_column("machine")
        for built_in, title in built_in_titles().items():
            table.add_row(built_in, title)
        out.print(table)
        return
    rig = load_rig(name, parse_settings(set_))
    out.print(f"{rig.name}: {rig.title}", markup=False, soft_wrap=True)
    out.print(_parameters(rig))
    off = sum(_is_off(entry) for entry in rig.entries.values())
    out.print(f"{off} parameters of physics that this machine does not have, or of effects, are off")


def _is_off(entry: "Entry") -> bool:
    return entry.source.startswith(_OFF)


def _parameters(rig: "Rig") -> "Table":
    """Every parameter that is not switched off."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("path", no_wrap=True)
    table.add_column("value", justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("range", no_wrap=True)
    table.add_column("source")
    for path, entry in rig.entries.items():
        if _is_off(entry):
            continue
        limits = f"{entry.range[0]:.4g} to {entry.range[1]:.4g}" if entry.range else ""
        source = f"same as {entry.same_as}" if entry.same_as else entry.source
        table.add_row(path, f"{rig.value(path):.6g}", entry.unit, limits, source)
    return table
