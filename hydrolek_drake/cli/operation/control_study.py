"""`hydrolek control judge` and `hydrolek control tune`: steps on changed machines."""

import json
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.errors import InputError

_ALL = tuple(f"{arm}_j{number}" for arm in ("right", "left") for number in range(1, 6))


def judge(
    controller: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="only this one (repeatable); the default is all")
    ] = None,
    joint: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="only this joint (repeatable), such as right_j2")
    ] = None,
    machines: Annotated[int, typer.Option(min=0, help="randomly deviating machines per joint, besides")] = 2,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="JSON file for all numbers")] = None,
    seed: Annotated[int, typer.Option(help="of noise and deviations")] = 1,
) -> None:
    """30 deg steps in both directions with other postures, loads, dead-zones, and on deviating machines."""
    from hydrolek_drake.control.names import TITLES, check_names

    names, joints = controller or list(TITLES), joint or list(_ALL)
    check_names(names)
    _check_joints(joints)

    import numpy as np

    from hydrolek_drake.cli.output import console, progress, text_table
    from hydrolek_drake.control.catalogue import build_law, rig_setting
    from hydrolek_drake.control.comparison.conditions import Condition, conditions_data, judged_conditions
    from hydrolek_drake.control.comparison.judged import as_json, as_rows
    from hydrolek_drake.control.comparison.judging import judge_all, make_cases
    from hydrolek_drake.control.laws.law import ControlLaw
    from hydrolek_drake.control.models.rig_model import control_step
    from hydrolek_drake.files import write_out
    from hydrolek_drake.rigs import load_rig

    generator = np.random.default_rng(seed)

    def law_of(name: str, which: str) -> ControlLaw:
        return build_law(name, settings[which], noisy=True)

    half = Condition(load_kg=0.5 * float(conditions_data()["load"]["value"]))
    with progress("step tests of every joint") as tell:
        settings = {name: rig_setting(load_rig(f"hydrolek_{name}"), name) for name in joints}
        step = control_step(load_rig(f"hydrolek_{joints[0]}"))
        cases = make_cases(joints, judged_conditions(), step)
        cases += make_cases(joints, [half] * machines, step, generator)
        found = {}
        for name in names:
            for learned in (False, True):
                tell(f"{name}, {'third' if learned else 'first'} step, {len(cases)} cases")
                found[name, learned] = judge_all(
                    partial(law_of, name),
                    cases,
                    seed,
                    learned=learned,
                )
    console().print(text_table(*as_rows(found)))
    if out is not None:
        write_out(out, json.dumps(as_json(found), indent=1) + "\n")


def tune(
    trials: Annotated[int, typer.Option(min=1, help="tunings to try; each takes some seconds")] = 60,
    joint: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="only this joint (repeatable), such as right_j2")
    ] = None,
    machines: Annotated[int, typer.Option(min=0, help="randomly deviating machines per joint, besides")] = 2,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="JSON file for the best tuning")] = None,
    seed: Annotated[int, typer.Option(help="of search and deviations")] = 3,
) -> None:
    """Tune feedforward control on perturbed machines; Ctrl-C keeps the best tuning so far."""
    from dataclasses import asdict

    import numpy as np
    from rich.console import Console

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.control.comparison.conditions import Condition, conditions_data, judged_conditions
    from hydrolek_drake.control.comparison.judging import make_cases
    from hydrolek_drake.control.comparison.tuning import tune as search
    from hydrolek_drake.control.laws.feedforward_tuning import FeedforwardTuning, tuning
    from hydrolek_drake.control.laws.rate_map import rig_model_and_rates
    from hydrolek_drake.control.models.rig_model import control_step
    from hydrolek_drake.files import write_out
    from hydrolek_drake.rigs import load_rig

    joints = joint or list(_ALL[:5])
    _check_joints(joints)
    generator = np.random.default_rng(seed)
    rigs = {name: load_rig(f"hydrolek_{name}") for name in joints}
    step = control_step(rigs[joints[0]])
    output, half = console(), Condition(load_kg=0.5 * float(conditions_data()["load"]["value"]))
    best: list[FeedforwardTuning] = [tuning()]

    def better(trial: int, cost: float, found: FeedforwardTuning) -> None:
        best[0] = found
        output.print(f"trial {trial}: {cost:.4f}", markup=False)

    interrupted = False
    with Console(stderr=True).status("tuning"):
        maps = {name: rig_model_and_rates(rig, name)[1] for name, rig in rigs.items()}
        cases = make_cases(joints, judged_conditions(), step)
        cases += make_cases(joints, [half] * machines, step, generator)
        try:
            search(tuning(), maps, cases, trials, generator, better)
        except KeyboardInterrupt:
            interrupted = True
    for key, value in asdict(best[0]).items():
        output.print(f"{key}: {value:.4g}", markup=False)
    if out is not None:
        write_out(out, json.dumps(asdict(best[0]), indent=1) + "\n")
    if interrupted:
        raise KeyboardInterrupt


def _check_joints(joints: list[str]) -> None:
    for name in joints:
        if name not in _ALL:
            raise InputError(f"--joint {name}: choose {', '.join(_ALL)}")
