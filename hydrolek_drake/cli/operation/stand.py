"""`hydrolek stand`: where to stand so that a pipe can be grasped and cut."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from hydrolek_drake.standing.answer import Answer

_Vector = tuple[float, float, float]


def stand(
    site: Annotated[
        Path | None,
        typer.Argument(
            metavar="[SITE]", help="YAML of pipe, grasp, cut and blocks; docs/guides/kinematics.md"
        ),
    ] = None,
    pipe_point: Annotated[
        _Vector | None,
        typer.Option(metavar="X Y Z", help="middle of the pipe in m: x forward, y left, z up from the floor"),
    ] = None,
    pipe_axis: Annotated[_Vector | None, typer.Option(metavar="X Y Z", help="along the pipe")] = None,
    pipe_radius: Annotated[float | None, typer.Option(metavar="M", help="of the pipe")] = None,
    pipe_length: Annotated[float | None, typer.Option(metavar="M", help="of the pipe")] = None,
    grasp: Annotated[float | None, typer.Option(metavar="M", help="along the pipe from its middle")] = None,
    cut: Annotated[float | None, typer.Option(metavar="M", help="likewise")] = None,
    grasping: Annotated[str, typer.Option(metavar="ARM", help="right, left, or either")] = "either",
    base: Annotated[
        Path | None,
        typer.Option(metavar="YAML", help="ranges of tracks and boom, in place of those that come along"),
    ] = None,
    count: Annotated[int, typer.Option(min=1, max=20, help="places to find")] = 3,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="folder for stand.json (which hydrolek teleop --stand takes) and stand.png"
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON instead of a table")] = False,
    seed: Annotated[int, typer.Option(min=0, help="of the path planner")] = 1,
) -> None:
    """Find places of tracks and boom from which one arm grasps and the other cuts; exit status 2 says why none."""
    import logging

    import numpy as np

    from hydrolek_drake.standing.base import load_base
    from hydrolek_drake.standing.site import make_site, read_site

    logging.getLogger("drake").setLevel(logging.WARNING)
    parts = {} if site is None else read_site(site)
    given = {"point": pipe_point, "axis": pipe_axis, "radius": pipe_radius, "length": pipe_length}
    parts["pipe"] = parts.get("pipe", {}) | {
        name: value for name, value in given.items() if value is not None
    }
    parts |= {name: value for name, value in (("grasp", grasp), ("cut", cut)) if value is not None}
    place = make_site(parts, "" if site is None else str(site))
    ranges = load_base(base)

    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.files import write_results
    from hydrolek_drake.standing.report import answer_json
    from hydrolek_drake.standing.search import StandingSearch

    with progress("mapping places by kinematics") as tell:
        search = StandingSearch(
            place, ranges, grasping=grasping, generator=np.random.default_rng(seed), tell=tell
        )
        answer = search.answer(count)
    found = answer_json(place, answer)
    if out is not None:
        from hydrolek_drake.standing.picture import standing_png

        write_results(
            out, {"stand.json": json.dumps(found, indent=1), "stand.png": standing_png(place, answer)}
        )
    if not answer.standings:
        raise InputError(f"stand: no place found: {answer.reason}")
    if as_json:
        print(json.dumps(found))
        return
    console().print(_table(answer))
    if out is not None:
        console().print(f"wrote {out / 'stand.json'} and {out / 'stand.png'}", markup=False, soft_wrap=True)


def _table(answer: "Answer") -> Any:
    import math

    from rich.table import Table

    table = Table(
        "place", "x / m", "y / m", "heading / deg", "boom / deg", "plate / m", "grasps",
        "least joint margin / deg", "arms clear / mm", "of what is wanted", "task / s",
    )  # fmt: skip
    for number, each in enumerate(answer.standings, 1):
        placement, margins = each.placement, each.margins
        table.add_row(
            str(number),
            f"{placement.x:.3f}",
            f"{placement.y:.3f}",
            f"{math.degrees(placement.heading):.1f}",
            f"{math.degrees(placement.boom):.1f}",
            f"{placement.plate_height():.3f}",
            each.grasping,
            f"{math.degrees(margins.joint):.1f} ({margins.joint_name})",
            f"{1e3 * margins.clearance:.0f}",
            f"{100.0 * margins.score:.0f} %",
            f"{each.plan.duration():.1f}",
        )
    return table
