#!/usr/bin/env python3
"""How far the Drake Diagram and the compiled rollout part over a random voltage, joint by joint.

Runs every instrumented joint of both arms with every effect off, and each effect on one joint after the other
(`--all` for each effect on every joint). To save time many joints share a diagram: a joint whose neighbours are
held is one rigid body on a fixed axis, so each case is a body of its own with that inertia and gravity. At the end
every joint runs on the arms' own plant, one of each arm at a time. Finished rows are kept, so an interrupted
study goes on where it was.

With `--own` the diagram takes the step that it takes where none is given, with `--closed` controllers drive both
executions; either writes its own table anew.
"""

import argparse
import datetime
import json
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from pydrake.multibody.tree import UniformGravityFieldElement

from hydrolek_drake.control.catalogue import build_law, rig_setting
from hydrolek_drake.control.closed_loop import loop_on_rollout
from hydrolek_drake.control.controlled_station import run_controlled
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.physics import load
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rigs.arm_loads import FROM_ARM
from hydrolek_drake.rigs.reading import rig_from_tree
from hydrolek_drake.rigs.rig import Rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes, sizes_for

JOINTS = [f"hydrolek_{side}_j{number}" for side in ("right", "left") for number in range(1, 6)]
GRAVITY = UniformGravityFieldElement.kDefaultStrength  # m/s^2, of Drake and of the arms
ROUNDING = 1e-9  # N m per kg m^2, of a gravity moment
SIZES = Path(__file__).parent / "agreement_effects.json"
BLOWS = "linkage.backlash"
"""Each closing of a play is a blow of a small inertia on a stiff spring, which takes 0.2 ms."""

RUBBING_BESIDE = {
    "cylinder.friction_asymmetry": "cylinder.coulomb_friction",
    "load.friction_asymmetry": "load.coulomb_friction",
}
"""What differs between the directions is a part of a friction. Alone it pushes in one of them, and feeds what rings
until a hair's breadth decides."""

CONTROLLERS = ("feedforward", "pip_idz_c", "pip_forward_c")
"""The project's own, and what the thesis recommends of feedback and of forward path for steps (section 6.3)."""

CLOSED, OWN = "in closed loop", "at the diagram's own step"
"""Tables that are written by themselves."""

BOUNCES = ("hydrolek_left_j4", BLOWS)
"""A light joint, a vane: it bounces where a hair's breadth decides, and both executions are of first order there."""


def share_of_step(case: tuple[str, str | None]) -> float:
    """Share of the step at which a case runs."""
    if case == BOUNCES:
        return 1.0 / 16.0
    return 0.25 if case[1] == BLOWS else 1.0


def random_voltage(duration: float, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Multi-level random voltage of section 6.1.4: levels within +-4 V, each held for 0.2 to 1 s."""
    times = np.arange(0.0, duration + 0.005, 0.01)
    volts = np.zeros(len(times))
    begin = 0.0
    while begin < duration:
        volts[times >= begin - 1e-9] = generator.uniform(-4.0, 4.0)
        begin += round(generator.uniform(0.2, 1.0), 2)
    return times, volts


def with_effect(rig: Rig, effect: str | None, joint: int = 0) -> Rig:
    """The rig with one effect on at one joint, at a size that is plainly visible, relative to the rig's own numbers."""
    if effect is None:
        return rig
    if effect in RUBBING_BESIDE:
        rig = with_effect(rig, RUBBING_BESIDE[effect], joint)
    sizes = json.loads(SIZES.read_text())[effect]
    record = rig.records()[joint]
    scale = {
        "force": float(record["cylinder"]["area_a"] * record["supply"]["pressure"]),
        "inertia": float(record["load"]["inertia"]),
        "friction": float(record["cylinder"]["viscous_friction"]),
        "stroke": float(record["cylinder"]["stroke"]),
    }
    where = f"joints.{rig.joints[joint]}.effects.{effect}"
    return rig.with_values(
        {f"{where}.{name}": value * scale.get(of, 1.0) for name, (value, of) in sizes.items()}
    )


def compare(rig: Rig, duration: float, step: float, *seeds: int) -> list[tuple[float, float]]:
    """Root mean square and largest difference of each joint's readings [deg], driven by one seed each."""
    drives = [random_voltage(duration, np.random.default_rng(seed)) for seed in seeds]
    times = drives[0][0]
    volts = np.column_stack([volts for _, volts in drives])
    station = make_station(rig, sizes=StepSizes(step=step), command=command_source(times, volts))
    readings = run(station, duration).signals["reading"]
    figures = []
    for i in range(len(rig.joints)):
        command = np.ascontiguousarray(volts[:, i])
        outcome = roll_out(rig.records()[i : i + 1], times, command, times, longest_step=step / 5.0)
        count = min(len(readings), len(times))
        difference = np.degrees(readings[:count, i] - outcome.signals.reading[:count])
        figures.append((float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max())))
    return figures


Case = tuple[str, str | None]
Row = tuple[
    str, str, str | None, float, float, float
]  # plant, joint, effect, step, root mean square, largest

ONE_BODY, ARMS = "one body", "arms"


def single(case: Case) -> Rig:
    """The rig of one case."""
    joint, effect = case
    return with_effect(load_rig(joint), effect)


def fits_one_body(case: Case) -> bool:
    """Whether a case may share a diagram of single bodies: not the pump's effects, and no payload out of its plane."""
    values = single(case).records()[0]["load"]
    moment = np.hypot(values["payload_gravity_cos"], values["payload_gravity_sin"])
    swings_upright = np.isclose(moment, GRAVITY * np.sqrt(values["payload_inertia"]), rtol=1e-3)
    effect = case[1] or ""
    return not effect.startswith("supply.") and (effect != "load.payload" or bool(swings_upright))


def bodies(cases: list[Case]) -> Rig:
    """A rig with one body a case; nothing but a pump of constant pressure is shared."""
    joints, common = {}, {}
    for number, case in enumerate(cases):
        rig = single(case)
        tree = rig.as_tree()
        common = {key: tree[key] for key in ("schema", "integration", "recording", "supply", "fluid")}
        [name] = rig.joints
        sections = tree["joints"][name]
        values = rig.records()[0]["load"]
        turning = {
            p.name: {"value": float(values[p.name]), "unit": p.unit, "source": "the arms, other joints held"}
            for p in load.STAGE.parameters("rotating")
            if p.name in FROM_ARM
        }
        if np.hypot(values["gravity_cos"], values["gravity_sin"]) < ROUNDING * values["inertia"]:
            for key in ("gravity_cos", "gravity_sin"):  # of an upright axis: no body has so small a moment
                turning[key]["value"] = 0.0
        sections["load"] = {**sections["load"], **turning, "variant": "rotating"}
        joints[f"case_{number}"] = sections
    return rig_from_tree({**common, "name": "agreement", "joints": joints}, Path("agreement"))


def parted(cases: list[Case]) -> list[list[Case]]:
    """Those of the cases that may share a diagram of single bodies, by its step."""
    fit = [case for case in cases if fits_one_body(case)]
    shares = dict.fromkeys(share_of_step(case) for case in fit)
    return [[case for case in fit if share_of_step(case) == share] for share in shares]


def on_the_arms(cases: list[Case]) -> Rig:
    """A rig of the arms that moves the joints of these cases; the others are held."""
    names = [joint.removeprefix("hydrolek_") for joint, _ in cases]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rig.yaml"
        path.write_text(f"schema: 1\nname: agreement\nbased_on: hydrolek\nkeep: [{', '.join(names)}]\n")
        rig = load_rig(path)
    for number, (_, effect) in enumerate(cases):
        rig = with_effect(rig, effect, number)
    return rig


def closed(joint: str, controllers: tuple[str, ...], step: float | None = None) -> list[float]:
    """Largest difference of a controlled joint's readings [deg], controller by controller.

    The joint is brought 18 deg forward and 11 deg back, with three seconds for each way.

    Args:
        joint: rig of one joint.
        controllers: of the catalogue.
        step: of the diagram [s]; the rig's own (`sizes_for`) if not given. The rollout takes its own.
    """
    rig = load_rig(joint)
    [name] = rig.joints
    setting, records = rig_setting(rig, name), rig.records()
    start = float(np.degrees(records["load"]["initial_position"][0]))
    wanted = np.repeat([start + 18.0, start + 7.0], round(3.0 / sample_s()))
    sizes = replace(sizes_for(rig), mount_forces=False)
    sizes = sizes if step is None else replace(sizes, step=step)
    figures = []
    for controller in controllers:
        law = build_law(controller, setting, noisy=False)
        diagram = run_controlled(rig, {name: law}, wanted[:, np.newaxis], sample_s(), sizes=sizes)
        plain = loop_on_rollout(
            law, records, wanted, sample_s(),
            rows_per_sample=1, longest_step=rig.value("integration.longest_step"),
        )  # fmt: skip
        figures.append(
            float(np.abs(diagram.angle_deg[:, 0] - plain.angle_deg[: len(diagram.angle_deg)]).max())
        )
    return figures


def closed_table() -> str:
    """The table of all joints under the controllers of `CONTROLLERS`, at the diagram's own step and half of it."""
    titles = [f"{name}, {which}" for name in CONTROLLERS for which in ("1 ms", "0.5 ms")]
    lines = [f"| joint | {' | '.join(titles)} |", "|---" * (1 + len(titles)) + "|"]
    for joint in JOINTS:
        own, half = closed(joint, CONTROLLERS), closed(joint, CONTROLLERS, 0.5e-3)
        cells = [f"{value:.4f}" for pair in zip(own, half, strict=True) for value in pair]
        lines.append(f"| {joint} | {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    return "\n".join(lines)


def own_table(duration: float) -> str:
    """The table of all joints at the step of `sizes_for`, without an effect and with a play that closes."""
    lines = ["| joint | effect on | step [ms] | rms [deg] | largest [deg] |", "|---|---|---|---|---|"]
    for effect in (None, BLOWS):
        rig = bodies([(joint, effect) for joint in JOINTS])
        step = sizes_for(rig).step
        figures = compare(rig, duration, step, *range(len(JOINTS)))
        lines += [
            f"| {joint} | {effect or '-'} | {1e3 * step:g} | {rms:.4f} | {largest:.4f} |"
            for joint, (rms, largest) in zip(JOINTS, figures, strict=True)
        ]
    return "\n".join(lines)


def write_table(out: Path, name: str, table: str) -> None:
    """Put a table between its two marks."""
    begins, ends = f"<!-- {name} -->\n", f"\n<!-- end: {name} -->"
    text = out.read_text()
    out.write_text(f"{text.partition(begins)[0]}{begins}{table}{ends}{text.partition(ends)[2]}")


def main() -> None:
    """Run the study and write docs/evidence/agreement.md, anew after each diagram."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--duration", type=float, default=60.0, help="seconds of random voltage per case")
    parser.add_argument("--step", type=float, default=0.4e-3, help="step of the diagram [s]")
    parser.add_argument("--all", action="store_true", help="then each effect on every other joint")
    parser.add_argument("--own", action="store_true", help="at the step that is taken where none is given")
    parser.add_argument("--closed", action="store_true", help="controllers in both executions")
    parser.add_argument("--out", type=Path, default=Path("docs/evidence/agreement.md"))
    arguments = parser.parse_args()
    if arguments.closed:
        write_table(arguments.out, CLOSED, closed_table())
        return
    if arguments.own:
        write_table(arguments.out, OWN, own_table(arguments.duration))
        return
    effects = list(json.loads(SIZES.read_text()))
    cases: list[Case] = [(joint, None) for joint in JOINTS]
    cases += [(JOINTS[i % len(JOINTS)], effect) for i, effect in enumerate(effects)]
    more = [(joint, effect) for joint in JOINTS for effect in effects if (joint, effect) not in cases]
    seeds = {case: number for number, case in enumerate(cases + more)}
    runs: list[tuple[str, list[Case]]] = [(ONE_BODY, part) for part in parted(cases)]
    runs += [(ARMS, [case]) for case in cases if not fits_one_body(case)]
    runs += [(ARMS, [(JOINTS[i], None), (JOINTS[i + 5], None)]) for i in range(5)]
    if arguments.all:
        for part in parted(more):
            runs += [(ONE_BODY, part[i : i + len(cases)]) for i in range(0, len(part), len(cases))]
        runs += [(ARMS, [case]) for case in more if not fits_one_body(case)]
    kept = arguments.out.with_suffix(".partial.json")
    rows: list[Row] = (
        [tuple(row) for row in read_kept(kept, "what an earlier run compared")] if kept.exists() else []
    )
    for plant, together in runs:
        if any(row[:3] == (plant, *together[0]) for row in rows):
            continue
        rig = bodies(together) if plant == ONE_BODY else on_the_arms(together)
        step = arguments.step * share_of_step(together[0])
        figures = compare(rig, arguments.duration, step, *(seeds[case] for case in together))
        rows += [(plant, *case, step, *figure) for case, figure in zip(together, figures, strict=True)]
        write_whole(kept, json.dumps(rows))
        for row in rows[-len(together) :]:
            print(
                "{:9s} {:18s} {!s:28s} step {:g} s: rms {:.4f} deg, largest {:.4f} deg".format(*row),
                flush=True,
            )
        wanted = set(cases + more if arguments.all else cases)
        done = len({row[1:3] for row in rows} & wanted)
        write(arguments.out, rows, f"{done} of {len(wanted)}", arguments.duration)
    kept.unlink()


def write(out: Path, rows: list[Row], done: str, duration: float) -> None:
    """Write the table of what is done; sections that were written below an older one stay."""
    _, heading, below = (out.read_text() if out.exists() else "").partition("\n## ")
    plant, joint, effect, _, _, worst = max(rows, key=lambda row: row[5])
    lines = [
        "# Diagram and rollout agree",
        "",
        f"Measured {datetime.date.today()} with `scripts/agreement.py`: {duration:g} s of random voltage a case, "
        "the rollout at a fifth of the diagram's",
        f"step. Required: 0.02 deg at any moment. Largest difference of all {len(rows)} runs: {worst:.4f} deg "
        f"({joint}, {effect or 'no effect'}, {plant}).",
        "",
        f"{done} cases are done: every joint without effects and with each effect. `one body`: many cases "
        "share a diagram,",
        "each a rigid body of its own with the inertia and gravity that the joint has while the others are held; "
        "`arms`: on the",
        "plant of both arms, a joint of each arm at a time.",
        "",
        "| plant | joint | effect on | step [ms] | rms [deg] | largest [deg] |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {p} | {j} | {e or '-'} | {1e3 * step:g} | {rms:.4f} | {largest:.4f} |"
        for p, j, e, step, rms, largest in rows
    ]
    write_whole(out, "\n".join(lines) + "\n" + heading + below)


if __name__ == "__main__":
    main()
