"""`hydrolek`: finds the command, runs it, and turns bad input into one line and exit status 2.

Only the module of the command that was asked for is loaded, so that `hydrolek --help` answers at once.
"""

import importlib
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from hydrolek_drake.errors import InputError, meant

if TYPE_CHECKING:
    import typer

BAD_INPUT = 2
INTERRUPTED = 130


class CommandEntry(NamedTuple):
    """Where a command lives; the attribute is a function with typer's annotations, or a typer app."""

    module: str
    attribute: str
    line: str


COMMANDS: dict[str, CommandEntry] = {
    "simulate": CommandEntry(
        "hydrolek_drake.cli.machines.simulate", "simulate", "run a scenario on its Drake diagram"
    ),
    "replay": CommandEntry(
        "hydrolek_drake.cli.machines.replay",
        "replay",
        "drive a rig's model with a recorded command and compare",
    ),
    "fit": CommandEntry(
        "hydrolek_drake.cli.identification.fit", "fit", "estimate a rig's free parameters from recordings"
    ),
    "diagnose": CommandEntry(
        "hydrolek_drake.cli.diagnosis.diagnose",
        "diagnose",
        "find out what physics the model leaves out, and model it",
    ),
    "demo": CommandEntry(
        "hydrolek_drake.cli.diagnosis.demo",
        "demo",
        "diagnose the project's own recordings of a machine that leaks",
    ),
    "watch": CommandEntry(
        "hydrolek_drake.cli.diagnosis.watch",
        "watch",
        "what changed on a machine since its reference; alarms, exit status 3",
    ),
    "sensitivity": CommandEntry(
        "hydrolek_drake.cli.identification.sensitivity",
        "sensitivity",
        "which parameters matter, and in which part",
    ),
    "identify": CommandEntry(
        "hydrolek_drake.cli.identification.identify",
        "identify",
        "models from recordings: sdp, two-step, force",
    ),
    "challenge": CommandEntry(
        "hydrolek_drake.cli.diagnosis.challenge",
        "challenge",
        "diagnose concealed machines of the project's own, and score",
    ),
    "effects": CommandEntry(
        "hydrolek_drake.cli.machines.effects", "effects", "list the known effects, or show one in full"
    ),
    "rigs": CommandEntry(
        "hydrolek_drake.cli.machines.rigs", "rigs", "list the built-in rigs, or one rig's parameters"
    ),
    "rig": CommandEntry(
        "hydrolek_drake.cli.machines.rig",
        "rig",
        "a new rig from a data sheet, or what is implausible about one",
    ),
    "export": CommandEntry(
        "hydrolek_drake.cli.machines.export",
        "export",
        "a rig's model as an FMU, for other programs' simulations",
    ),
    "fmu": CommandEntry(
        "hydrolek_drake.cli.machines.fmu",
        "fmu",
        "other programs' FMUs in place of a machine: show, or record one",
    ),
    "ik": CommandEntry(
        "hydrolek_drake.cli.operation.ik", "ik", "joint angles for a target, or what prevents it"
    ),
    "stand": CommandEntry(
        "hydrolek_drake.cli.operation.stand", "stand", "where to stand so that a pipe can be grasped and cut"
    ),
    "carry": CommandEntry(
        "hydrolek_drake.cli.operation.carry", "carry", "both arms hold one pipe and move it"
    ),
    "vision": CommandEntry(
        "hydrolek_drake.cli.operation.vision",
        "vision",
        "edges, selected object and targets of one camera frame",
    ),
    "teleop": CommandEntry(
        "hydrolek_drake.cli.operation.teleop", "teleop", "the operator's console in the browser"
    ),
    "serve": CommandEntry(
        "hydrolek_drake.cli.operation.serve",
        "serve",
        "the controllers' end of the console's link, for another machine",
    ),
    "show": CommandEntry(
        "hydrolek_drake.cli.machines.show", "show", "show a saved run of the arms in the browser"
    ),
    "control": CommandEntry(
        "hydrolek_drake.cli.operation.control",
        "control",
        "compare controllers (bench, judge), design (design) or tune one (tune)",
    ),
    "benchmark": CommandEntry(
        "hydrolek_drake.cli.diagnosis.benchmark", "benchmark", "speed and exactness of the executions"
    ),
}
"""Name -> entry, in the order of the help."""


def main() -> None:
    """Entry point of the `hydrolek` program."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Run one command line.

    Returns:
        Exit status: 0 for success, 2 for bad input, 130 if the user interrupted.
    """
    try:
        return _dispatch(list(arguments))
    except InputError as error:
        return _refuse(str(error), BAD_INPUT)
    except KeyboardInterrupt:
        return _refuse("interrupted", INTERRUPTED)
    except BrokenPipeError:  # the reader, such as `head`, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _dispatch(arguments: list[str]) -> int:
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(_overview())
        return 0
    name, *rest = arguments
    if name == "--version":
        from hydrolek_drake import __version__

        print(f"hydrolek {__version__}")
        return 0
    if name not in COMMANDS:
        kind = "option" if name.startswith("-") else "command"
        hint = meant(name, COMMANDS, most=2)
        raise InputError(
            f"no {kind} '{name}'; {hint}the commands are {', '.join(COMMANDS)}; see hydrolek --help"
        )
    return _run_command(name, rest)


def typer_app(name: str) -> "typer.Typer":
    """A command as typer knows it.

    Args:
        name: one of `COMMANDS`.
    """
    import typer

    entry = COMMANDS[name]
    found: Any = getattr(importlib.import_module(entry.module), entry.attribute)
    if isinstance(found, typer.Typer):
        return found
    app = typer.Typer(add_completion=False, rich_markup_mode=None)
    app.command()(found)
    return app


def _run_command(name: str, arguments: list[str]) -> int:
    import typer

    from hydrolek_drake.linear_algebra import in_one_thread

    found = typer_app(name)
    click_error = typer.BadParameter.__mro__[
        2
    ]  # ClickException: some versions of typer carry their own click
    assert issubclass(click_error, Exception)
    try:
        with in_one_thread():
            status = typer.main.get_command(found).main(
                arguments, prog_name=f"hydrolek {name}", standalone_mode=False
            )
    except click_error as error:
        said: Any = error  # its type is typer's or click's
        problem = " ".join(said.format_message().split()).rstrip(".")
        return _refuse(f"{name}: {problem}; see hydrolek {name} --help", BAD_INPUT)
    except typer.Abort:
        return _refuse("interrupted", INTERRUPTED)
    if status == INTERRUPTED:
        return _refuse("interrupted", INTERRUPTED)
    return status if isinstance(status, int) else 0


def _overview() -> str:
    width = max(map(len, COMMANDS))
    return "\n".join(
        [
            "usage: hydrolek COMMAND ...",
            "",
            "Digital twin of hydraulic manipulators: replay recordings, find the physics that is missing.",
            "",
            "commands:",
            *(f"  {name:<{width}}  {entry.line}" for name, entry in COMMANDS.items()),
            "",
            "hydrolek COMMAND --help tells more.",
            "exit status: 0 success, 1 something looks wrong (rig check), 2 bad input, 3 an alarm, 130 interrupted",
        ]
    )


def _refuse(message: str, status: int) -> int:
    print(f"hydrolek: {' '.join(message.split())}", file=sys.stderr)
    return status
