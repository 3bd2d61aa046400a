#!/usr/bin/env python3
"""The thesis's unexplained observations: a HydroLek recording with each symptom and a concealed cause, diagnosed.

The machine is the Drake Diagram of one joint with every free parameter off by up to 5 %, one effect on, and the
sensor's noise; it is recorded under random voltage (section 6.1.4) or under a controller. The diagnosis knows the
rig's nominal numbers, voltage and angle. Finished riddles are kept, so an interrupted study goes on.
"""

import argparse
import datetime
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.control.catalogue import build_law, rig_setting
from hydrolek_drake.control.controlled_station import run_controlled
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.diagnosis.diagnosis import diagnose
from hydrolek_drake.diagnosis.report.as_json import as_json
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.identification.parameter_set import free_of_joints
from hydrolek_drake.recordings import read_recording, write_signals
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes
from hydrolek_drake.yaml_files import read_yaml

RIDDLES = Path(__file__).parent / "riddles.yaml"
SPREAD = 0.05
PARTS = {"train": 30.0, "holdout": 20.0}
SAMPLE_S = 0.01
SIZES = StepSizes(step=2.5e-4)
"""The machine is to move as its physics says: at 1 ms the step's error of some 0.01 deg passes for a small effect."""


def joints_of(riddle: dict[str, Any]) -> list[str]:
    """The joints that move."""
    return [riddle["joint"]] if "joint" in riddle else riddle["joints"]


def rig_of(riddle: dict[str, Any]) -> Rig:
    """One joint with the others held, or the whole machine if several move."""
    return load_rig(f"hydrolek_{riddle['joint']}" if "joint" in riddle else "hydrolek", {})


def machine_of(rig: Rig, riddle: dict[str, Any], generator: np.random.Generator) -> Rig:
    """The joints with their own numbers and the concealed effect, which acts on the first of them."""
    moving = joints_of(riddle)
    own = {}
    for free in free_of_joints(rig, moving):
        value = rig.value(free.path) * generator.uniform(1.0 - SPREAD, 1.0 + SPREAD)
        own[free.path] = min(max(value, free.lower), free.upper)
    record = rig.records()[rig.joints.index(moving[0])]
    full_force = float(record["cylinder"]["area_a"] * record["supply"]["pressure"])
    for effect, parameters in riddle["effects"].items():
        joint = rig.owner(EFFECTS[effect], moving[0])
        for name, value in parameters.items():
            if name == "force_share":
                own[f"joints.{joint}.effects.{effect}.coulomb_N"] = value * full_force
            else:
                own[f"joints.{joint}.effects.{effect}.{name}"] = value
    return rig.with_values(own)


def random_voltage(duration: float, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Levels within +-4 V, each held for 0.2 to 1 s, at rest for the first half second."""
    times = np.arange(0.0, duration + 0.5 * SAMPLE_S, SAMPLE_S)
    volts = np.zeros(times.size)
    begin = 0.5
    while begin < duration:
        volts[times >= begin - 1e-9] = generator.uniform(-4.0, 4.0)
        begin += round(generator.uniform(0.2, 1.0), 2)
    return times, volts


def record(rig: Rig, riddle: dict[str, Any], folder: Path, seed: int) -> None:
    """Write `train.csv` and `holdout.csv`."""
    generator = np.random.default_rng(seed)
    machine = machine_of(rig, riddle, generator)
    moving = joints_of(riddle)
    folder.mkdir(parents=True, exist_ok=True)
    for part, seconds in PARTS.items():
        if "controller" in riddle:
            time, volts, angle = _controlled(rig, machine, riddle, seconds, generator)
        else:
            time, volts, angle = _open(rig, machine, moving, seconds, generator)
        signals: dict[str, np.ndarray] = {}
        units: dict[str, str] = {}
        for i, joint in enumerate(moving):
            signals |= {f"{joint}.command": volts[:, i], f"{joint}.angle": angle[:, i]}
            units |= {f"{joint}.command": "V", f"{joint}.angle": "rad"}
        write_signals(folder / f"{part}.csv", time, signals, units)


def _open(
    rig: Rig, machine: Rig, moving: list[str], seconds: float, generator: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Random voltage on every moving joint; the others' valves stay closed."""
    places = [rig.joints.index(joint) for joint in moving]
    series = [random_voltage(seconds, generator) for _ in moving]
    time = series[0][0]
    volts = np.zeros((time.size, len(rig.joints)))
    for place, (_, own) in zip(places, series, strict=True):
        volts[:, place] = own
    station = make_station(machine, command=command_source(time, volts), noise=generator, sizes=SIZES)
    angle = run(station, seconds).signals["measured"]
    count = min(time.size, len(angle))
    return time[:count], volts[:count, places], angle[:count, places]


def _controlled(
    rig: Rig, machine: Rig, riddle: dict[str, Any], seconds: float, generator: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Steps between random set points; the controller was designed on the nominal machine."""
    joint = riddle["joint"]
    law = build_law(riddle["controller"], rig_setting(rig, joint), noisy=True)
    period = sample_s()
    samples = round(seconds / period)
    start = float(np.degrees(rig.records()[0]["load"]["initial_position"]))
    wanted = np.full(samples, start)
    for first in range(round(0.5 / period), samples, round(4.0 / period)):
        wanted[first:] = start + generator.uniform(-20.0, 20.0)
    done = run_controlled(machine, {joint: law}, wanted[:, None], period, noise=generator, sizes=SIZES)
    noise = np.radians(0.05) * generator.standard_normal(done.time_s.size)
    return done.time_s, done.voltage_V, np.radians(done.angle_deg) + noise[:, None]


def solved(riddle: dict[str, Any], report: dict[str, Any]) -> bool:
    """Whether the concealed cause, and nothing else, is named."""
    named = {e["id"] for e in report["effects"]}
    return report["verdict"] == "missing_physics" and named == set(riddle["effects"])


def markdown(riddles: list[dict[str, Any]], reports: list[dict[str, Any]]) -> str:
    """The page."""
    lines = [
        "# The thesis's riddles, diagnosed",
        "",
        "What the thesis observes and leaves unexplained. For each one a HydroLek joint is recorded that shows the",
        "symptom because of one concealed cause (`scripts/riddles.yaml`): the Drake Diagram of the joint, its own",
        "numbers up to 5 % off, the potentiometer's noise, random voltage or a controller, angle and voltage only.",
        "That a cause is found here does not say that it is the thesis's cause; it says that the tool would name it.",
        "",
        f"Measured {datetime.date.today().isoformat()} with `scripts/riddles.py`.",
        "",
        "| riddle | concealed | verdict | named | held-out error / noise, before -> after | s | right |",
        "|---|---|---|---|---|---|---|",
    ]
    for riddle, report in zip(riddles, reports, strict=True):
        named = "; ".join(
            _told(e["id"], {name: known["value"] for name, known in e["parameters"].items()})
            + f" p {e['probability']:.2f}"
            for e in report["effects"]
        )
        hidden = "; ".join(_told(name, values) for name, values in riddle["effects"].items())
        fit = report["fit"]
        after = fit["with_effects"]["holdout_over_noise"]
        cells = [
            f"{riddle['riddle']} ({riddle['thesis']})",
            f"{', '.join(joints_of(riddle))}: {hidden}",
            report["verdict"],
            named or "-",
            f"{fit['baseline']['holdout_over_noise']:.2f} -> {after:.2f}",
            f"{report['seconds']:.0f}",
            "yes" if solved(riddle, report) else "no",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    lines += ["", "In the tool's own words:", ""]
    lines += [
        f"- {riddle['riddle']}: {report['sentence']}" for riddle, report in zip(riddles, reports, strict=True)
    ]
    return "\n".join(lines) + "\n"


def _told(effect: str, values: dict[str, float]) -> str:
    return f"{effect} ({', '.join(f'{name} {value:.3g}' for name, value in values.items())})"


def main() -> None:
    """Record, diagnose, write the table (docs/evidence/riddles.md has it)."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/riddles"))
    parser.add_argument("--page", type=Path, help="for the table; riddles.md in --out if not given")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", type=int, help="number of one riddle, from 1")
    arguments = parser.parse_args()
    riddles = read_yaml(RIDDLES, "list of riddles")
    chosen = [n for n in range(1, len(riddles) + 1) if arguments.only in (None, n)]
    reports = []
    with ThreadPoolExecutor(arguments.workers) as pool:
        for number in chosen:
            riddle = riddles[number - 1]
            folder = arguments.out / f"riddle_{number}"
            kept = folder / "report.json"
            if not kept.exists():
                rig = rig_of(riddle)
                record(rig, riddle, folder, arguments.seed + number)
                training, holdout = (read_recording(folder / f"{p}.csv", rig.columns) for p in PARTS)
                report = as_json(diagnose(rig, [training], [holdout], pool, print))
                write_whole(kept, json.dumps(report, indent=1))
            report = read_kept(kept, "the report of a riddle diagnosed before")
            print(number, report["verdict"], [e["id"] for e in report["effects"]], solved(riddle, report))
            reports.append(report)
    if arguments.only is None:
        write_whole(arguments.page or arguments.out / "riddles.md", markdown(riddles, reports))


if __name__ == "__main__":
    main()
