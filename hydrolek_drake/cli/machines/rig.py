"""`hydrolek rig`: a new rig from a data sheet, what is implausible about one, and the schema for editors."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.inputs import tell_of_clocks
from hydrolek_drake.cli.settings import SeedOption, SetOption, parse_settings
from hydrolek_drake.errors import InputError

if TYPE_CHECKING:  # the commands load what they need
    from hydrolek_drake.recordings import Recording
    from hydrolek_drake.rigs import Rig

rig = typer.Typer(add_completion=False, rich_markup_mode=None, no_args_is_help=True)
"""The commands."""

WRONG = 1
"""Exit status of a check that found something wrong."""


@rig.command(
    context_settings={"allow_extra_args": True, "ignore_unknown_options": True},
    options_metavar="FILE [OPTIONS]",
)
def new(
    context: typer.Context,
    out_file: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="FILE", help="rig file to be written, such as my_axis.yaml; or FILE alone"
        ),
    ] = None,
    questions: Annotated[bool, typer.Option("--questions", help="list all questions and end")] = False,
    force: Annotated[bool, typer.Option("--force", help="write over a file that is there")] = False,
    seed: SeedOption = None,
) -> None:
    """Write a commented rig from what a data sheet says.

    Each question is an option, such as --bore '40 mm'; in a terminal, those that are needed and missing are asked.
    What nobody knows is assumed, with a wide range, and says so in the file.
    """
    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.wizard import questions as all_questions

    out = console()
    if questions:
        width = max(len(each.option) for each in all_questions().values()) + 1
        for each in all_questions().values():
            kind = f" [{each.unit}]" if each.unit else f" ({', '.join(each.choices)})" if each.choices else ""
            told = "needed" if each.needed else "optional"
            out.print(f"{each.option:<{width}} {each.asks}{kind}, {told}", markup=False, soft_wrap=True)
        return
    given, files = _pairs(context.args)
    files += [str(out_file)] if out_file else []
    if len(files) > 1:
        raise InputError(
            f"rig new: {' and '.join(files)}: one FILE is written; an option's value stands behind it in quotes, "
            "such as --bore '40 mm'"
        )
    if not files:
        raise InputError("rig new: no FILE to write, such as my_axis.yaml")
    file = Path(files[0])
    if file.suffix not in (".yaml", ".yml"):
        raise InputError(f"rig new: {file} is no YAML file; name it {file.with_suffix('.yaml')}")
    if file.exists() and not force:
        raise InputError(f"rig new: {file} is there already; --force writes over it")
    if not file.parent.is_dir():
        raise InputError(f"rig new: {file}: there is no folder {file.parent}")
    if sys.stdin.isatty():
        _ask(given)

    from hydrolek_drake.files import write_whole
    from hydrolek_drake.wizard.making import written_rig

    with progress("trying the rig's steps (the first time, the physics is compiled: half a minute)"):
        text, made = written_rig(file.stem, given)
    write_whole(file, text)
    free = made.free_parameters()
    assumed = [path for path, entry in made.entries.items() if entry.source.startswith("assumed")]
    out.print(f"wrote {file}: {len(free)} numbers with a range, {len(assumed)} assumed", markup=False)
    _say(made, None)


@rig.command()
def check(
    name: Annotated[str, typer.Argument(metavar="RIG", help="name of a built-in rig, or a rig file")],
    recordings: Annotated[
        list[Path] | None, typer.Argument(metavar="[RECORDING]...", help="recordings of the machine")
    ] = None,
    set_: SetOption = None,
    seed: SeedOption = None,
) -> int:
    """Say what looks wrong about a rig and its recordings, with the line that mends it.

    Exit status 1 if anything does.
    """
    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.recordings import read_recording
    from hydrolek_drake.rigs import load_rig

    loaded = load_rig(name, parse_settings(set_))
    with progress("checking (the first time, the physics is compiled: half a minute)"):
        wrong = _say(loaded, None)
        for path in recordings or []:
            recording = read_recording(path, loaded.columns, dead_time=loaded.dead_time)
            tell_of_clocks(recording, console())
            wrong += _say(loaded, recording)
    if not wrong:
        console().print("nothing looks wrong")
    return WRONG if wrong else 0


@rig.command()
def schema(seed: SeedOption = None) -> None:
    """Print the JSON schema of rig files, for completion and checks in editors."""
    from hydrolek_drake.rigs.reading.json_schema import rig_schema

    print(json.dumps(rig_schema(), indent=1))


def _say(loaded: "Rig", recording: "Recording | None") -> int:
    """Print complaints; how many of them are wrong."""
    from hydrolek_drake.checking.recording_checks import check_recording
    from hydrolek_drake.checking.rig_checks import check_rig
    from hydrolek_drake.cli.output import console

    out = console()
    found = check_rig(loaded) if recording is None else check_recording(loaded, recording)
    for each in found:
        begin = "wrong?" if each.wrong else "note:"
        out.print(f"{begin} {each.sentence()}", markup=False, soft_wrap=True)
    return sum(each.wrong for each in found)


def _pairs(arguments: list[str]) -> tuple[dict[str, str], list[str]]:
    """`--name value` and `--name=value` as pairs, and what stands behind no option."""
    given: dict[str, str] = {}
    files: list[str] = []
    left = list(arguments)
    while left:
        name = left.pop(0)
        if not name.startswith("--"):
            files.append(name)
            continue
        name, equals, value = name.partition("=")
        if not equals:
            if not left:
                raise InputError(f"rig new: {name} needs a value")
            value = left.pop(0)
        if name in given:
            raise InputError(f"rig new: {name} is given twice")
        given[name] = value
    return given, files


def _ask(given: dict[str, str]) -> None:
    """Ask for what is missing, until each answer is one; Enter leaves open what can be assumed."""
    from hydrolek_drake.wizard import questions, read_answers

    for question in questions().values():
        answers = read_answers(given)
        if question.key in answers or not question.applies(answers):
            continue
        kind = f" [{question.unit}]" if question.unit else f" ({'/'.join(question.choices)})"
        while True:
            text = typer.prompt(f"{question.asks}{kind}", default="", show_default=False).strip()
            if not text and not question.needed:
                break
            try:
                read_answers({question.key: text})
            except InputError as error:
                typer.echo(str(error), err=True)
                continue
            given[question.option] = text
            break
