"""`hydrolek control`: controllers compared, and designed."""

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.cli.operation.control_study import judge, tune
from hydrolek_drake.cli.settings import SeedOption, SetOption, parse_settings
from hydrolek_drake.errors import InputError

control = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    no_args_is_help=True,
    help="Compare controllers, or design one.",
)


control.command()(judge)
control.command()(tune)


class Plant(str, Enum):
    """What is controlled."""

    sdp = "sdp"
    full = "full"


@control.command()
def bench(
    plant: Annotated[
        Plant, typer.Option(help="SDP models of Table 6.1, or the full machine with all joints at once")
    ] = Plant.sdp,
    rig: Annotated[str, typer.Option(metavar="RIG", help="machine of --plant full")] = "hydrolek",
    controller: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="only this one (repeatable); the default is all")
    ] = None,
    sequence: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="only step, sine or grasp (repeatable)")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for page, pictures and numbers")
    ] = None,
    set_: SetOption = None,
    seed: Annotated[int, typer.Option(help="of the sensors' noise on the full machine")] = 1,
) -> None:
    """Every controller on step, sine and grasp, measured as in appendix G, beside the thesis's models or machine."""
    from hydrolek_drake.cli.output import console, progress, text_table
    from hydrolek_drake.control.comparison.sequences import NAMES
    from hydrolek_drake.control.names import TITLES, check_names
    from hydrolek_drake.rigs import load_rig

    names, sequences = controller or list(TITLES), sequence or list(NAMES)
    check_names(names)
    for name in sequences:
        if name not in NAMES:
            raise InputError(f"--sequence {name}: choose {', '.join(NAMES)}")
    if plant is Plant.sdp and (set_ or rig != "hydrolek"):
        raise InputError("--plant sdp: the SDP models read no rig; --set and --rig belong to --plant full")
    machine = load_rig(rig, parse_settings(set_)) if plant is Plant.full else None

    from hydrolek_drake.control.comparison.bench import bench_on_machine, bench_on_models
    from hydrolek_drake.control.comparison.bench_tables import ranking_rows, sentence
    from hydrolek_drake.runs.report import prepare_folder

    if out is not None:
        prepare_folder(out)
    output = console()
    with progress("starting (the first time, the physics is compiled: some 20 s)") as tell:
        if machine is None:
            done = bench_on_models(names, sequences, progress=tell)
        else:
            done = bench_on_machine(machine, names, sequences, seed=seed, progress=tell)
    for said in done.failed:
        output.print(f"failed: {said}", markup=False, soft_wrap=True)
    if not done.trials:
        raise KeyboardInterrupt
    output.print(sentence(done), markup=False, soft_wrap=True)
    output.print()
    output.print(text_table(*ranking_rows(done)))
    if out is not None:
        from hydrolek_drake.control.comparison.bench_report import write_bench

        output.print(f"\nreport: {write_bench(done, out)}", markup=False, soft_wrap=True)
    if done.interrupted:
        raise KeyboardInterrupt


@control.command()
def design(
    rig: Annotated[
        str, typer.Argument(metavar="RIG", help="a rig, a YAML file with an SDP model, or thesis")
    ],
    joint: Annotated[
        str | None,
        typer.Argument(metavar="[JOINT]", help="joint of the rig, or j1 to j4, j4_linear of the thesis"),
    ] = None,
    weights: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="ERROR INPUTS OUTPUT", help="LQ weights; the default is tuning c of Table 6.6"),
    ] = None,
    pole: Annotated[
        list[str] | None,
        typer.Option(metavar="RE[+IMj]", help="a closed-loop pole (repeatable); the rest are placed at 0"),
    ] = None,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="YAML file for the controller")] = None,
    set_: SetOption = None,
    seed: SeedOption = None,
) -> None:
    """PIP controller with inverse dead-zone for one joint: from a rig's step tests, or from an SDP model."""
    import yaml

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.files import is_file
    from hydrolek_drake.rigs import load_rig

    if weights is not None and pole:
        raise InputError("give either --weights or --pole, not both")
    # A file may hold a model or a rig; a name that is neither is told before what designs is loaded.
    machine = None if rig == "thesis" or is_file(Path(rig)) else load_rig(rig, parse_settings(set_))

    from hydrolek_drake.control.designed import design_controller, is_model_file, read_model, write_designed
    from hydrolek_drake.control.models.rig_model import rig_model
    from hydrolek_drake.control.models.sdp_model import thesis_model
    from hydrolek_drake.control.thesis_gains import entry

    if rig == "thesis":
        model = thesis_model(joint or "")
    elif machine is None and is_model_file(Path(rig)):
        model = read_model(Path(rig))
    else:
        machine = machine or load_rig(rig, parse_settings(set_))
        if joint is None and len(machine.joints) > 1:
            raise InputError(f"rig {rig} has several joints; name one of {', '.join(machine.joints)}")
        model = rig_model(machine, joint or machine.joints[0])
    poles = tuple(_complex(text) for text in pole) if pole else None
    if poles is None and weights is None:
        first, second, third = map(float, entry("pip_idz.c", "j2")["weights"])
        weights = (first, second, third)
    designed = design_controller(model, weights=weights, poles=poles)
    console().print(
        yaml.safe_dump(designed.as_tree(), sort_keys=False).rstrip(), markup=False, soft_wrap=True
    )
    if out is not None:
        write_designed(designed, out)


def _complex(text: str) -> complex:
    try:
        return complex(text.replace(" ", ""))
    except ValueError:
        raise InputError(f"--pole {text}: write a number such as 0.7 or 0.7+0.05j") from None
