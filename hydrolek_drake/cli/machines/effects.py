"""`hydrolek effects`: the physics that diagnosis can name."""

from typing import Annotated

import typer

from hydrolek_drake.cli.settings import SeedOption


def effects(
    effect_id: Annotated[
        str | None, typer.Argument(metavar="[ID]", help="such as cylinder.cross_port_leakage")
    ] = None,
    seed: SeedOption = None,
) -> None:
    """List the known effects, or show one in full."""
    from hydrolek_drake.cli.output import console
    from hydrolek_drake.effects.catalogue import EFFECTS, effect_named

    out = console()
    if effect_id is None:
        from rich.table import Table

        table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
        table.add_column("id", no_wrap=True)
        table.add_column("what it is")
        table.add_column("stage", no_wrap=True)
        for effect in sorted(EFFECTS.values(), key=lambda effect: effect.id):
            table.add_row(effect.id, effect.title, effect.stage)
        out.print(table)
        return
    effect = effect_named(effect_id)
    lines = [
        f"{effect.id}: {effect.title}",
        "",
        f"stage     {effect.stage}",
        f"equation  {effect.equation}",
        f"source    {effect.source}",
        "",
        "parameters",
        *(
            f"  {p.name} [{p.unit}]: {p.meaning}; {p.neutral:g} when switched off"
            for p in effect.parameters
            if p.neutral is not None
        ),
    ]
    if effect.inspect:
        lines += ["", f"on the machine: {effect.inspect}"]
    if effect.needs:
        needs = (f"{section} {' or '.join(variants)}" for section, variants in effect.needs.items())
        lines += ["", f"acts only on {', '.join(needs)}"]
    if effect.confused_with:
        lines += ["", "can be confused with"]
        lines += [f"  {other}: {difference}" for other, difference in effect.confused_with.items()]
    for line in lines:
        out.print(line, markup=False, soft_wrap=True)
