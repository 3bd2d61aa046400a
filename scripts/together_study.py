#!/usr/bin/env python3
"""Concealed machines of which several joints are recorded while they move together, diagnosed.

Machines are drawn by a seed: two or three joints of one arm, their numbers up to 5 % off, and in seven of ten an
effect at one of them or at the pump that feeds all, of such a size that the joint's own rollout moves by six times the
noise. The labels' SHA-256 is told before the first diagnosis. The machine is the Drake Diagram of both arms with a
quarter of its usual step, so that, other than in `hydrolek challenge`, it shares its equations with the diagnosis:
what is asked is whether joints are told apart, not whether the equations are right. Finished cases are kept, so an
interrupted study goes on.
"""

import argparse
import hashlib
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from riddles import PARTS, random_voltage, record, rig_of

from hydrolek_drake.challenge.build import build_of
from hydrolek_drake.diagnosis.diagnosis import diagnose
from hydrolek_drake.diagnosis.report.as_json import as_json
from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

SHOWN = 6.0
"""An effect leaves so many times the noise in its joint's own rollout."""

SIZINGS = 4
LARGEST_SCALING = 20.0
"""As in `hydrolek challenge`: beyond, a worn joint would have been scrapped."""

SHARED = "supply.pressure_droop"
KINDS = ("healthy",) * 3 + ("one joint",) * 5 + ("shared",) * 2
THREE = 0.2
"""Share of cases with three joints."""


def drawn(count: int, seed: int) -> list[dict[str, Any]]:
    """Labels of so many cases."""
    generator = np.random.default_rng(seed)
    kinds = generator.permutation([KINDS[i % len(KINDS)] for i in range(count)])
    return [_label(number, str(kind), generator) for number, kind in enumerate(kinds, start=1)]


def _label(number: int, kind: str, generator: np.random.Generator) -> dict[str, Any]:
    side = str(generator.choice(["left", "right"]))
    how_many = 3 if generator.random() < THREE else 2
    numbers = generator.choice([1, 2, 3, 4, 5], how_many, replace=False)
    joints = [f"{side}_j{n}" for n in numbers]  # an effect of one joint acts on the first
    effects: dict[str, dict[str, float]] = {}
    if kind != "healthy":
        listed = build_of(load_rig(f"hydrolek_{joints[0]}", {})).listed
        names = [SHARED] if kind == "shared" else sorted(set(listed) - {SHARED})
        name = str(generator.choice(names))
        effects[name] = _sized(joints[0], name, listed[name], generator)
    seed = int(generator.integers(2**31))
    return {
        "name": f"case_{number:02d}",
        "kind": kind,
        "joints": sorted(joints),
        "at": joints[0] if kind == "one joint" else None,
        "effects": effects,
        "seed": seed,
    }


def _sized(joint: str, name: str, entry: dict[str, Any], generator: np.random.Generator) -> dict[str, float]:
    """Parameters with which the joint alone shows the effect as wanted."""
    rig = load_rig(f"hydrolek_{joint}", {})
    fixed = {p: float(np.exp(generator.uniform(*np.log(ends)))) for p, ends in entry.get("draw", {}).items()}
    sign = -1.0 if entry.get("signed") and generator.random() < 0.5 else 1.0
    times, volts = random_voltage(PARTS["train"], generator)
    prefix = "effects." if name == SHARED else f"joints.{joint}.effects."

    def moved(parameters: dict[str, float]) -> np.ndarray:
        other = rig.with_values({f"{prefix}{name}.{p}": value for p, value in parameters.items()})
        step = rig.value("integration.longest_step")
        return roll_out(other.records(), times, volts, times, longest_step=step).signals.reading

    plain, noise, factor = moved({}), rig.value(f"joints.{joint}.sensor.noise"), 1.0
    parameters: dict[str, float] = {}
    for _ in range(SIZINGS):
        parameters = {p: sign * value * factor for p, value in entry["size"].items()} | fixed
        shown = float(np.sqrt(np.mean((moved(parameters) - plain) ** 2))) / noise
        ratio = SHOWN / max(shown, 0.02)
        factor *= 1.0 / ratio if entry.get("weakens") else ratio
        factor = min(max(factor, 1.0 / LARGEST_SCALING), LARGEST_SCALING)
    return parameters


def row(label: dict[str, Any], report: dict[str, Any]) -> str:
    """A case as a line of a table."""
    named = [f"{e['id']} {e['probability']:.2f}" for e in report["effects"]]
    places = sorted({f"{place['stage']} {place['joint'] or ''}".strip() for place in report["locations"]})
    hidden = [f"{name} {_numbers(values)}" for name, values in label["effects"].items()] or ["nothing"]
    fit = report["fit"]
    cells = [
        label["name"],
        " ".join(label["joints"]),
        f"{hidden[0]}{' at ' + label['at'] if label['at'] else ''}",
        report["verdict"],
        ", ".join(named) or "-",
        ", ".join(places) or "-",
        f"{fit['baseline']['train_over_noise']:.2f}, {fit['baseline']['holdout_over_noise']:.2f}",
        f"{fit['with_effects']['train_over_noise']:.2f}, {fit['with_effects']['holdout_over_noise']:.2f}",
        f"{report['seconds']:.0f}",
        "yes" if right(label, report) else "no",
    ]
    return f"| {' | '.join(cells)} |"


def right(label: dict[str, Any], report: dict[str, Any]) -> bool:
    """Whether what is concealed, and nothing else, is named, and at its joint."""
    named = {e["id"] for e in report["effects"]}
    joints = {place["joint"] for place in report["locations"]}
    where = label["at"] is None or joints == {label["at"]}
    wanted = "missing_physics" if label["effects"] else "none"
    return report["verdict"] == wanted and named == set(label["effects"]) and where


def _numbers(values: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.3g}" for name, value in values.items())


HEAD = (
    "| case | joints | concealed | verdict | named | where | nominal: fitted, held out | with effects | s | right |",
    "|---|---|---|---|---|---|---|---|---|---|",
)


def main() -> None:
    """Draw, tell the hash, record and diagnose one case after the other."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/together"))
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    labels = drawn(arguments.cases, arguments.seed)
    text = json.dumps(labels, indent=1, sort_keys=True)
    print("labels sha256", hashlib.sha256(text.encode()).hexdigest(), flush=True)
    arguments.out.mkdir(parents=True, exist_ok=True)
    write_whole(arguments.out / "labels.json", text)
    lines = list(HEAD)
    with ThreadPoolExecutor(arguments.workers) as pool:
        for label in labels:
            folder = arguments.out / label["name"]
            kept = folder / "report.json"
            rig = rig_of(label)
            if not (folder / "holdout.csv").exists():
                at_first = {"joints": [label["at"] or label["joints"][0]], "effects": label["effects"]}
                at_first["joints"] += [j for j in label["joints"] if j not in at_first["joints"]]
                record(rig, at_first, folder, label["seed"])
            if not kept.exists():
                training, holdout = (read_recording(folder / f"{p}.csv", rig.columns) for p in PARTS)
                write_whole(
                    kept, json.dumps(as_json(diagnose(rig, [training], [holdout], pool, _quiet)), indent=1)
                )
            lines.append(row(label, read_kept(kept, "the report of a case diagnosed before")))
            print(lines[-1], flush=True)
            write_whole(arguments.out / "cases.md", "\n".join(lines) + "\n")


def _quiet(text: str) -> None:
    """A study tells its cases, not what each one is doing."""


if __name__ == "__main__":
    main()
