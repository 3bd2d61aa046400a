"""`hydrolek show`: a saved run in the browser, without simulating it again."""

from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.cli.settings import SeedOption
from hydrolek_drake.errors import InputError


def show(
    run: Annotated[
        Path,
        typer.Argument(
            metavar="DIR|FILE", help="folder of hydrolek simulate --out, or a recording of the arms"
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="write a stand-alone page instead of opening a view"),
    ] = None,
    seed: SeedOption = None,
) -> None:
    """Show a saved run of the arms as a 3-D animation with a time slider."""
    from hydrolek_drake.cli.output import console
    from hydrolek_drake.files import write_out
    from hydrolek_drake.visualization.controls import with_open_controls
    from hydrolek_drake.visualization.loopback_server import loopback_visualizer
    from hydrolek_drake.visualization.saved_run import draw_saved_run, read_saved_run

    if out is not None and not out.absolute().parent.is_dir():
        raise InputError(f"--out {out}: its folder {out.parent} does not exist")
    output = console()
    saved = read_saved_run(run)
    with loopback_visualizer() as view:
        draw_saved_run(saved, view)
        if out is not None:
            write_out(out, with_open_controls(view.static_html()))
            output.print(f"animation: {out}", markup=False, soft_wrap=True)
            return
        output.print(
            f"open {view.url()} in a browser on this machine; Ctrl-C ends it", markup=False, soft_wrap=True
        )
        _stay()


def _stay() -> None:
    import time

    try:
        while True:
            time.sleep(1.0)
    except KeyboardInterrupt:
        return
