#!/usr/bin/env python3
"""How far the Drake Diagram and the compiled rollout part over a random voltage, joint by joint.

A joint of the right arm and one of the left, which do not act on each other, share a diagram to save time.

Runs every instrumented joint of both arms with every effect off, and each effect on one joint after the other
(`--all` for each effect on every joint, which takes hours), and writes a table. Finished rows are kept, so an
interrupted study goes on where it was.
"""

import argparse
import datetime
import json
import tempfile
from itertools import zip_longest
from pathlib import Path

import numpy as np

from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rigs.rig import Rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import StepSizes, make_station

JOINTS = [f"hydrolek_{side}_j{number}" for side in ("right", "left") for number in range(1, 6)]
SIZES = Path(__file__).parent / "agreement_effects.json"


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
    sizes = json.loads(SIZES.read_text())[effect]
    record = rig.records()[joint]
    scale = {
        "force": float(record["cylinder"]["area_a"] * record["supply"]["pressure"]),
        "inertia": float(record["load"]["inertia"]),
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


def rig_of(cases: list[Case]) -> Rig:
    """A rig that moves the joints of these cases, each with its effect on."""
    names = [joint.removeprefix("hydrolek_") for joint, _ in cases]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rig.yaml"
        path.write_text(f"schema: 1\nname: agreement\nbased_on: hydrolek\nkeep: [{', '.join(names)}]\n")
        rig = load_rig(path)
    for joint, effect in cases:
        rig = with_effect(rig, effect, rig.joints.index(joint.removeprefix("hydrolek_")))
    return rig


def shared_runs(cases: list[Case]) -> list[list[Case]]:
    """Cases that run in one diagram: one of each arm, but an effect of the pump, which is shared, runs alone."""
    alone = [[case] for case in cases if (case[1] or "").startswith("supply.")]
    arms = [[case for case in cases if side in case[0] and [case] not in alone] for side in ("right", "left")]
    pairs = [[case for case in pair if case is not None] for pair in zip_longest(*arms)]
    return pairs + alone


def main() -> None:
    """Run the study and write docs/agreement.md, anew after each case."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--duration", type=float, default=60.0, help="seconds of random voltage per case")
    parser.add_argument("--step", type=float, default=0.5e-3, help="step of the diagram [s]")
    parser.add_argument("--all", action="store_true", help="then each effect on every other joint")
    parser.add_argument("--out", type=Path, default=Path("docs/agreement.md"))
    arguments = parser.parse_args()
    effects = list(json.loads(SIZES.read_text()))
    cases: list[Case] = [(joint, None) for joint in JOINTS]
    cases += [(JOINTS[i % len(JOINTS)], effect) for i, effect in enumerate(effects)]
    required = len(cases)
    if arguments.all:
        cases += [(joint, effect) for joint in JOINTS for effect in effects if (joint, effect) not in cases]
    kept = arguments.out.with_suffix(".partial.json")
    rows: dict[str, list[float]] = json.loads(kept.read_text()) if kept.exists() else {}
    seeds = {case: number for number, case in enumerate(cases)}
    done = []
    runs = shared_runs(cases[:required]) + shared_runs(cases[required:])
    for together in runs:
        keys = [f"{joint} {effect or ''} {arguments.duration} {arguments.step}" for joint, effect in together]
        if not all(key in rows for key in keys):
            rig = rig_of(together)
            places = [rig.joints.index(joint.removeprefix("hydrolek_")) for joint, _ in together]
            in_rig_order = sorted(zip(places, together, strict=True))
            figures = compare(
                rig, arguments.duration, arguments.step, *(seeds[case] for _, case in in_rig_order)
            )
            rows.update({key: list(figures[place]) for key, place in zip(keys, places, strict=True)})
            kept.write_text(json.dumps(rows))
        for key, case in zip(keys, together, strict=True):
            done.append((*case, *rows[key]))
            print(
                f"{case[0]:18s} {case[1] or 'no effect':28s} rms {rows[key][0]:.4f} deg, "
                f"largest {rows[key][1]:.4f} deg",
                flush=True,
            )
        done.sort(key=lambda row: seeds[row[:2]])
        write(arguments.out, done, required, arguments.duration, arguments.step)
    kept.unlink()


def write(
    out: Path,
    done: list[tuple[str, str | None, float, float]],
    required: int,
    duration: float,
    step: float,
) -> None:
    """Write the table of the cases that are done."""
    joint, effect, _, worst = max(done, key=lambda row: row[3])
    lines = [
        "# Diagram and rollout agree",
        "",
        f"Measured {datetime.date.today()} with `scripts/agreement.py`: {duration:g} s of random voltage a case, "
        f"diagram at {step * 1e3:g} ms, rollout at a fifth of",
        f"that. Required: 0.02 deg at any moment. Largest difference of all: {worst:.4f} deg "
        f"({joint}, {effect or 'no effect'}).",
        "",
        f"{min(len(done), required)} of {required} cases are done: every joint without effects and each effect on one "
        f"joint; and {max(len(done) - required, 0)} more, effects on further joints (`--all`).",
        "",
        "| joint | effect on | rms [deg] | largest [deg] |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {joint} | {effect or '-'} | {rms:.4f} | {largest:.4f} |" for joint, effect, rms, largest in done
    ]
    draft = out.with_name(f".{out.name}.part")
    draft.write_text("\n".join(lines) + "\n")
    draft.replace(out)


if __name__ == "__main__":
    main()
