"""`hydrolek carry`: both arms hold one pipe and move it."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from hydrolek_drake.errors import InputError

_Vector = tuple[float, float, float]
_UP: _Vector = (0.0, 0.0, 1.0)


def carry(
    shift: Annotated[
        _Vector | None,
        typer.Option(metavar="X Y Z", help="of the pipe's middle in m, world frame; 0.08 m up if not given"),
    ] = None,
    turn: Annotated[
        float, typer.Option(metavar="DEG", help="about --turn-axis through the pipe's middle")
    ] = 0.0,
    turn_axis: Annotated[_Vector, typer.Option(metavar="X Y Z", help="world frame")] = _UP,
    pipe_point: Annotated[
        _Vector | None, typer.Option(metavar="X Y Z", help="middle of the pipe, world, m")
    ] = None,
    pipe_axis: Annotated[_Vector | None, typer.Option(metavar="X Y Z", help="along the pipe, world")] = None,
    pipe_length: Annotated[float | None, typer.Option(metavar="M", help="of the pipe")] = None,
    apart: Annotated[
        float | None, typer.Option(metavar="M", help="distance of each hand from the pipe's middle")
    ] = None,
    plant: Annotated[
        str, typer.Option(help="full: simulate both arms with their hydraulics; none: plan only")
    ] = "full",
    controller: Annotated[
        str, typer.Option(help="of the full plant, a name of `hydrolek control bench`")
    ] = "feedforward",
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for carry.json, carry.csv and carry.png")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON instead of a table")] = False,
    seed: Annotated[int, typer.Option(min=0, help="of path planner and sensors")] = 1,
) -> None:
    """Plan both arms' joints for a path of a pipe that both hold, simulate it, and tell the force between the arms."""
    import logging
    import math

    import numpy as np

    from hydrolek_drake.control.names import check_names

    if plant not in ("full", "none"):
        raise InputError(f"carry: --plant {plant} is unknown; choose full or none")
    check_names([controller])

    from hydrolek_drake.carrying.plan import Move, carry_entries, pipe_to_carry, plan_carry
    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.files import write_results

    logging.getLogger("drake").setLevel(logging.WARNING)  # once pydrake has set it up
    way = carry_entries("move")["shift"] if shift is None else shift
    move = Move(np.array(way, dtype=float), np.array(turn_axis, dtype=float), math.radians(turn))
    pipe = pipe_to_carry(pipe_point, pipe_axis, pipe_length)
    found: dict[str, Any] = {}
    contents: dict[str, bytes | str] = {}
    with progress("planning") as tell:
        planned = plan_carry(pipe, move, np.random.default_rng(seed), apart=apart, on_step=tell)

        from hydrolek_drake.carrying.report import carried_figures, carried_png, plan_figures

        found["plan"] = plan_figures(planned)
        if plant == "full":
            from hydrolek_drake.carrying.simulation import simulate_carry

            carried = simulate_carry(planned, controller=controller, seed=seed, tell=tell)
            found["plant"] = carried_figures(carried)
            contents |= {"carry.png": carried_png(planned, carried), "carry.csv": carried.csv()}
    contents["carry.json"] = json.dumps(found, indent=1)
    if out is not None:
        write_results(out, contents)
    if as_json:
        print(json.dumps(found))
        return
    console().print(_table(found))
    if "plant" in found:
        off, most = (found["plant"][name] for name in ("chain_error_mm", "tolerance_mm"))
        console().print(
            f"the hands came {off:.1f} mm off their hold, {'within' if off <= most else 'beyond'} the {most:g} mm "
            "that are tolerated"
        )
    if out is not None:
        console().print(
            f"wrote {', '.join(str(out / name) for name in contents)}", markup=False, soft_wrap=True
        )


def _table(found: dict[str, Any]) -> Any:
    from rich.table import Table

    table = Table("of", "figure", "value")
    for part, figures in found.items():
        for name, value in figures.items():
            table.add_row(part, name.replace("_", " "), f"{value:.4g}")
    return table
