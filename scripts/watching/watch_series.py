"""Concealed machines watched while load, oil temperature and operator change from recording to recording.

python scripts/watching/watch_series.py --seed 71 --out out/watch_series

Ten machines of the challenge (equations and an integrator of their own), the bench and joints of the arms: five healthy
ones, and five in each of which one effect grows from nothing to ten times the smallest visible size, by the same every
day. Every recording, the reference's too, has a load, an oil temperature and an operator of its own. The watch is told
which numbers change (`CHANGES`). The labels' hash is printed before anything is watched; the same command goes on.
"""

import argparse
import hashlib
import json
import os
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from hydrolek_drake.challenge.build import ARM_JOINTS, BENCH, build_of
from hydrolek_drake.challenge.cases import driven, with_concealed, write_played
from hydrolek_drake.challenge.drawing import LARGEST_SCALING, SHOWS, SIZING_STEP_S, individual
from hydrolek_drake.diagnosis.intervals.curvature import NORMAL
from hydrolek_drake.files import write_whole
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.results import write_watch
from hydrolek_drake.watching.watch import watch

DAY_S = 86400.0
REFERENCES = 3
EFFECTS = (
    "cylinder.cross_port_leakage",
    "cylinder.coulomb_friction",
    "fluid.entrained_air",
    "linkage.backlash",
    "supply.pressure_droop",
    "sensor.drift",
)
VISIBLE = SHOWS["barely"]
"""An effect of the smallest visible size changes what is read by so many times the noise, root mean square."""

AT_LAST = 10.0
"""Sizes at the end, over the smallest visible one."""

ONSETS = (4, 9)
"""An effect begins with one of these days, the last one excluded."""

CHANGES = ("load.payload", "cylinder.viscous_friction")
DRIFT = {"fluid.bulk_modulus": 0.05}
"""What the watch is told, as by `--changes` and `--drift`."""

WARMER_K = 4.0
"""The oil is warmer or colder by up to so much than the rig's numbers say."""

HALVED_K = 15.0
"""Mineral oil loses half of its viscosity over so much (as `fluid.warm_up`)."""

FLOW_PER_K, BULK_PER_K = 3.7e-4, -5e-3
"""Orifice flow by half of the density's fall of 0.65 kg/m^3 a kelvin; bulk modulus of mineral oil."""

HEAVIEST_KG = {"bench": 5.0, "arm": 15.0}
"""Bench: 1 m from the axis (its rig), a fifth of its gravity moment; arms: twice `sizes.yaml`."""

BENCH_RANGE = "[2.0e+3, 4.5e+3]"
"""Viscous friction of a bench whose oil is not always as warm [N s/m]."""


def machine_in(build, healthy, label, day):
    """The machine as it is in one recording."""
    share = max(label["sizes"][day], 0.0) if day >= 0 else 0.0
    concealed = {}
    if label["effect"] and share:
        concealed[label["effect"]] = {p: share * v for p, v in label["at_last"].items()} | label["drawn"]
    kilograms, kelvin = label["loads"][day + REFERENCES], label["temperatures"][day + REFERENCES]
    area = [name for name in ("area", "area_max_a", "area_max_b") if hasattr(healthy, name)]
    changed = {name: getattr(healthy, name) * (1.0 + FLOW_PER_K * kelvin) for name in area}
    changed["c_cyl"] = healthy.c_cyl * 2.0 ** (-kelvin / HALVED_K)
    changed["bulk"] = healthy.bulk * (1.0 + BULK_PER_K * kelvin)
    if build.rig.name == BENCH:
        per = {each: build.rig.value(f"load.{each}") for each in ("payload_inertia", "payload_gravity_cos")}
        changed["inertia"] = healthy.inertia + kilograms * per["payload_inertia"]
        changed["mgl"] = healthy.mgl + kilograms * per["payload_gravity_cos"]
    else:
        concealed["load.payload"] = {"mass_kg": kilograms, "time_s": 0.0}
    return with_concealed(healthy._replace(**changed), concealed)


def operated(build, operator):
    """The build as one operator drives it."""
    driving = build.driving
    pace, reach = operator["pace"], operator["reach"]
    own = {name: getattr(driving, name) * pace for name in ("shortest_s", "longest_s")}
    for side in "ab":
        least, most = getattr(driving, f"least_{side}"), getattr(driving, f"most_{side}")
        own[f"most_{side}"] = least + reach * (most - least)
    return replace(build, driving=driving._replace(**own, gain=driving.gain * reach))


def played(build, healthy, label, day, seconds):
    """What was commanded and what the machine did."""
    operator = label["operators"][day + REFERENCES]
    own, rng = operated(build, operator), np.random.default_rng((label["seed"], day + REFERENCES))
    machine = machine_in(build, healthy, label, day)
    return driven(own, machine, operator["drive"], seconds, rng, build.noise, SIZING_STEP_S), rng


def shown(build, healthy, label, share, seconds, days=(0, 1, 2)):
    """By how many times the noise an effect of some share of its last size changes what is read, over some days."""
    squares = []
    for day in days:
        at = {**label, "sizes": {day: share}}
        done, _ = played(build, healthy, at, day, seconds)
        without = machine_in(build, healthy, {**at, "effect": ""}, day)
        plain = build.replay(without, done.volts, SIZING_STEP_S)
        squares.append(np.mean((done.reading - plain.reading) ** 2))
    return float(np.sqrt(np.mean(squares))) / build.noise


def visible_of(build, healthy, label, seconds):
    """The smallest visible size; as in the challenge within a factor of sizes.yaml.

    A play shows something, however small its gap is, by what moves within it: its size then says nothing.
    """
    factor = 1.0
    for _ in range(4):
        at = {**label, "at_last": {p: v * factor for p, v in label["at_last"].items()}}
        factor *= VISIBLE / max(shown(build, healthy, at, 1.0, seconds), 1e-3)
        factor = min(max(factor, 1.0 / LARGEST_SCALING), LARGEST_SCALING)
    return {p: v * factor for p, v in label["at_last"].items()}


def labels(machines, days, seconds, seed):
    """What is concealed in each machine and what changes about it, drawn at random."""
    rng = np.random.default_rng(seed)
    rigs = [BENCH] * (machines // 2) + [str(each) for each in rng.permutation(ARM_JOINTS)]
    rigs = [str(each) for each in rng.permutation(rigs[:machines])]
    effects = [str(each) for each in rng.permutation(EFFECTS)][: machines // 2]
    effects = [str(each) for each in rng.permutation([*effects, *[""] * (machines - len(effects))])]
    found, count = [], days + REFERENCES
    for rig, effect in zip(rigs, effects, strict=True):
        build = build_of(load_rig(rig))
        own = individual(build, rng)
        heaviest = HEAVIEST_KG["bench" if rig == BENCH else "arm"]
        entry = build.listed[effect] if effect else {}
        sign = float(rng.choice([-1.0, 1.0])) if entry.get("signed") else 1.0
        onset = int(rng.integers(*ONSETS))
        label = {
            "rig": rig,
            "effect": effect,
            "onset": onset,
            "sizes": [max(day - onset + 1, 0) / (days - onset) for day in range(days)],
            "at_last": {p: sign * v for p, v in entry.get("size", {}).items()},
            "drawn": {},
            "machine": own,
            "loads": rng.uniform(0.0, heaviest, count).tolist(),
            "temperatures": rng.uniform(-WARMER_K, WARMER_K, count).tolist(),
            "operators": [
                {
                    "drive": str(rng.choice(["open", "closed"])),
                    "pace": float(rng.uniform(0.7, 1.5)),
                    "reach": float(rng.uniform(0.6, 1.0)),
                }
                for _ in range(count)
            ],
            "seed": int(rng.integers(2**31)),
        }
        healthy = build.nominal._replace(**own)
        label["at_last"] = visible_of(build, healthy, label, seconds) if effect else {}
        label["at_last"] = {p: v * AT_LAST for p, v in label["at_last"].items()}
        found.append(label)
    return found


def record(build, label, folder, days, seconds):
    """Write the reference recordings and one a day."""
    healthy = build.nominal._replace(**label["machine"])
    folder.mkdir(parents=True, exist_ok=True)
    for day in range(-REFERENCES, days):
        done, rng = played(build, healthy, label, day, seconds)
        name = f"reference_{day + REFERENCES}.csv" if day < 0 else f"run_2026-03-{day + 1:02d}.csv"
        write_played(folder / name, build, done, rng)


def watched_rig(name, folder):
    """The rig that the watch is given: the bench's says that its friction is that of warm or cold oil."""
    if name != BENCH:
        return load_rig(name)
    path = folder / "bench.yaml"
    text = (
        f"schema: 1\nname: bench\nbased_on: {BENCH}\njoints:\n  joint:\n    cylinder:\n      viscous_friction: "
        f"{{value: 3000, unit: N s/m, source: 'the bench, warm or cold', range: {BENCH_RANGE}, scale: log}}\n"
    )
    write_whole(path, text)
    return load_rig(str(path))


def visible_sizes(label, watched):
    """Sizes that would bring just the gain which an effect needs, by how surely recordings tell the planted one.

    That is the smallest size which the machine's own numbers, and what changes, leave visible (as
    `diagnosis.intervals.visible`), in each recording since the onset that holds the effect apart from nothing.
    """
    found = []
    for answer in watched.answers[label["onset"] :]:
        told = next((e for e in answer.effects if e.effect == label["effect"]), None)
        if told is not None and told.low * told.high > 0.0:
            deviation = (told.high - told.low) / (2.0 * NORMAL)
            found.append(float(np.sqrt(answer.needed)) * deviation)
    return found


def row_of(label, watched, seconds, wall):
    """How a machine was told."""
    alarm = watched.alarm
    gains = [max(e.gain for e in answer.effects) for answer in watched.answers]
    row = {
        "rig": label["rig"],
        "planted": label["effect"],
        "onset": label["onset"] + 1 if label["effect"] else None,
        "named": alarm.effect if alarm else "",
        "as_well": list(alarm.as_well) if alarm else [],
        "since": alarm.since + 1 if alarm else None,
        "raised": alarm.raised + 1 if alarm else None,
        "beyond": [n + 1 for n, j in enumerate(watched.judgements) if j.beyond],
        "unlisted": bool(alarm and alarm.unlisted),
        "inflation": watched.healthy.inflation,
        "largest_gain": max(gains),
        "processor_s_a_recording": seconds / max(watched.anew, 1),
        "clock_s_a_recording": wall / max(watched.anew, 1),
        "load": os.getloadavg()[0],
    }
    if alarm and label["effect"]:
        row["size_since_over_visible"] = AT_LAST * label["sizes"][alarm.since]
        row["size_raised_over_visible"] = AT_LAST * label["sizes"][alarm.raised]
    if alarm and alarm.effect == label["effect"] and alarm.joint:
        [size, *_] = label["at_last"].values()
        told = visible_sizes(label, watched)
        if told:
            row["smallest_visible_told"] = float(np.median(told))
            at = abs(size) * label["sizes"][alarm.raised]
            row["size_raised_over_visible_told"] = at / row["smallest_visible_told"]
        trend = watched.trend(alarm.effect, alarm.joint)
        if trend.last is not None:
            days = len(label["sizes"]) - label["onset"]
            row["growth_over_planted"] = trend.last.slope * DAY_S / (size / days)
    return row


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--machines", type=int, default=10)
    parser.add_argument("--recordings", type=int, default=30)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--cores", type=int, default=1)
    parser.add_argument("--untold", action="store_true", help="do not tell the watch what changes")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    if not (given.out / "labels.json").exists():
        drawn = labels(given.machines, given.recordings, given.seconds, given.seed)
        write_whole(given.out / "labels.json", json.dumps(drawn, sort_keys=True, indent=1))
    text = (given.out / "labels.json").read_text()
    print("labels", hashlib.sha256(text.encode()).hexdigest(), flush=True)
    rows = []
    for number, label in enumerate(json.loads(text)):
        folder = given.out / f"machine_{number:02d}"
        if not (folder / "whole").exists():
            record(build_of(load_rig(label["rig"])), label, folder, given.recordings, given.seconds)
            write_whole(folder / "whole", "")
        begun, clock = time.process_time(), time.monotonic()
        reference, later = (sorted(folder.glob(each)) for each in ("reference_*.csv", "run_*.csv"))
        out = folder / ("untold" if given.untold else "out")
        told = {} if given.untold else {"changes": CHANGES, "drift": DRIFT}
        with ThreadPoolExecutor(given.cores) as pool:
            rig = watched_rig(label["rig"], folder)
            watched = watch(rig, reference, later, folder=out, cores=given.cores, pool=pool, **told)
        write_watch(watched, out)
        rows.append(row_of(label, watched, time.process_time() - begun, time.monotonic() - clock))
        print(json.dumps(rows[-1]), flush=True)
        write_whole(given.out / "study.json", json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
