"""Concealed cases: which machine, which effect, how large, how driven."""

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hydrolek_drake.challenge.bench_machine import (
    LISTED,
    SAMPLE_S,
    SPREAD,
    STEP_S,
    Machine,
    Played,
    nominal_machine,
    play,
    with_effects,
)
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.rigs import Rig

INDIVIDUAL = 0.12
"""Machines of one build differ by so much, uniformly."""

SHOWS = {"barely": 1.5, "middle": 6.0, "large": 30.0}
"""Size of an effect: how many times the noise the nominal equations, with the machine's own numbers, are wrong."""

KINDS = (("healthy", 0.3), ("single", 0.45), ("double", 0.12), ("unlisted", 0.13))
"""Kind of case -> share of all."""

TRAIN_S, HOLDOUT_S = 40.0, 30.0
SIZING_STEP_S = 5e-5
"""Integration step while an effect's size is sought, which need not be exact."""

SCALINGS = 3
LARGEST_SCALING = 20.0
"""Sizes stay within this factor of those in sizes.yaml: beyond, a worn joint would have been scrapped."""


@dataclass(frozen=True)
class Case:
    """One machine and what is concealed in it.

    Attributes:
        name: of its folder.
        kind: one of `KINDS`.
        size: one of `SHOWS`, or none for a healthy one.
        drive: open or closed.
        pressures: whether the chamber pressures are recorded.
        effects: listed effects with their parameters.
        unlisted: physics in no list with its numbers.
        stages: where it acts.
        machine: the numbers that differ from the rig's.
        seed: of commands and noise.
    """

    name: str
    kind: str
    size: str
    drive: str
    pressures: bool
    effects: dict[str, dict[str, float]]
    unlisted: dict[str, dict[str, float]]
    stages: tuple[str, ...]
    machine: dict[str, float]
    seed: int


def draw_cases(rig: Rig, count: int, seed: int) -> list[Case]:
    """Cases in random order, so that the first ones are a fair sample of all.

    Args:
        rig: its numbers, which are all that machine and diagnosis share.
        count: how many.
        seed: of everything random.
    """
    rng = np.random.default_rng(seed)
    sizes = yaml.safe_load(resources.files(__package__).joinpath("sizes.yaml").read_text())
    kinds = [kind for kind, share in KINDS for _ in range(max(round(share * count), 1))][:count]
    kinds += ["single"] * (count - len(kinds))
    listed = _in_turn(list(sizes["listed"]), rng)
    unlisted = _in_turn(list(sizes["unlisted"]), rng)
    levels = _in_turn(list(SHOWS), rng)
    drafts = []
    for kind in kinds:
        names = [next(listed) for _ in range({"single": 1, "double": 2}.get(kind, 0))]
        if {"cylinder.coulomb_friction", "cylinder.stribeck_friction"} <= set(names):
            names[1] = next(listed)
        level = "" if kind == "healthy" else next(levels) if kind == "single" else "middle"
        drafts.append((kind, level, names, [next(unlisted)] if kind == "unlisted" else []))
    rng.shuffle(drafts)
    return [_case(rig, sizes, n, *draft, rng) for n, draft in enumerate(drafts, start=1)]


def _in_turn(items: list[str], rng: np.random.Generator) -> Any:
    """Every item once, in random order, again and again."""
    while True:
        yield from rng.permutation(items).tolist()


def _case(
    rig: Rig,
    sizes: Mapping[str, Any],
    number: int,
    kind: str,
    level: str,
    names: list[str],
    strange: list[str],
    rng: np.random.Generator,
) -> Case:
    own = {
        f: rig.value(path) * float(rng.uniform(1 - INDIVIDUAL, 1 + INDIVIDUAL)) for f, path in SPREAD.items()
    }
    machine = nominal_machine(rig)._replace(**own)
    drive = "closed" if rng.random() < 0.5 else "open"
    pressures = bool(rng.random() < 0.5)
    seed = int(rng.integers(2**31))
    concealed: list[tuple[str, Any, str | None]] = [(name, sizes["listed"][name], name) for name in names]
    concealed += [(name, sizes["unlisted"][name], None) for name in strange]
    scaled: dict[str, dict[str, float]] = {}
    for tried in dict.fromkeys((drive, "open")):
        found = {
            name: _scaled(machine, entry, level, tried, seed, rng, listed)
            for name, entry, listed in concealed
        }
        drive = tried
        scaled = {name: parameters for name, (parameters, _) in found.items()}
        if all(
            shows for _, shows in found.values()
        ):  # a controller may keep a joint from where an effect shows
            break
    effects = {name: scaled[name] for name in names}
    unlisted = {name: scaled[name] for name in strange}
    stages = [name.split(".")[0] for name in names] + [sizes["unlisted"][name]["stage"] for name in strange]
    return Case(
        f"case_{number:03d}", kind, level, drive, pressures, effects, unlisted, tuple(stages), own, seed
    )


def machine_of(rig: Rig, case: Case) -> Machine:
    """The machine of a case."""
    plain = nominal_machine(rig)._replace(**case.machine)
    fields = {name: value for numbers in case.unlisted.values() for name, value in numbers.items()}
    return with_effects(plain, case.effects)._replace(**fields)


def _scaled(
    machine: Machine,
    entry: Mapping[str, Any],
    level: str,
    drive: str,
    seed: int,
    rng: np.random.Generator,
    name: str | None,
) -> tuple[dict[str, float], bool]:
    """Parameters of an effect, scaled until it shows as much as wanted, and whether it does."""
    drawn = {p: float(math.exp(rng.uniform(*np.log(ends)))) for p, ends in entry.get("draw", {}).items()}
    sign = -1.0 if entry.get("signed") and rng.random() < 0.5 else 1.0
    factor = 1.0
    parameters: dict[str, float] = {}
    shown = 0.0
    for _ in range(SCALINGS):
        parameters = {p: sign * v * factor for p, v in entry["size"].items()} | drawn
        changed = with_effects(machine, {name: parameters}) if name else machine._replace(**parameters)
        shown = _mismatch(machine, changed, drive, seed)
        if not math.isfinite(shown):
            shown = 10.0 * SHOWS["large"]
        ratio = SHOWS[level] / max(shown, 0.02)
        factor *= 1.0 / ratio if entry.get("weakens") else ratio
        factor = min(max(factor, 1.0 / LARGEST_SCALING), LARGEST_SCALING)
    return parameters, shown > 0.5 * SHOWS[level]


def _mismatch(plain: Machine, changed: Machine, drive: str, seed: int) -> float:
    """Root mean square of what the machine without the effect does otherwise in the training data, over the noise."""
    done = _drive(changed, drive, TRAIN_S, np.random.default_rng(seed), 0.0, SIZING_STEP_S)
    without = play(plain, done.volts, step=SIZING_STEP_S)
    return float(np.sqrt(np.mean((done.reading - without.reading) ** 2))) / math.radians(0.05)


def _drive(
    machine: Machine, drive: str, seconds: float, rng: np.random.Generator, noise: float, step: float = STEP_S
) -> Played:
    count = round(seconds / SAMPLE_S)
    levels: list[float] = [0.0] * 50
    while len(levels) < count:
        hold = int(rng.uniform(0.3, 2.0) / SAMPLE_S)
        if drive == "open":
            levels += [0.0 if rng.random() < 0.2 else float(rng.uniform(-8.0, 8.0))] * hold
        else:
            levels += [math.radians(rng.uniform(0.0, 58.0))] * (3 * hold)
    series = np.array(levels[:count])
    if drive == "open":
        return play(machine, series, step=step)
    series[:50] = math.radians(25.0)
    return play(machine, None, series, gain=12.0, noise=noise * rng.standard_normal(count), step=step)


def record(rig: Rig, case: Case, folder: Path) -> None:
    """Write `train.csv` and `holdout.csv` of a case, with the noise and resolution that the rig states."""
    rng = np.random.default_rng(case.seed)
    noise, step = (rig.value(f"joints.joint.sensor.{name}") for name in ("noise", "resolution"))
    pressure_noise = rig.value("joints.joint.sensor.pressure_noise")
    folder.mkdir(parents=True, exist_ok=True)
    machine = machine_of(rig, case)
    for name, seconds in (("train", TRAIN_S), ("holdout", HOLDOUT_S)):
        done = _drive(machine, case.drive, seconds, rng, noise)
        reading = done.reading + noise * rng.standard_normal(done.reading.size)
        signals = {"joint.command": done.volts, "joint.angle": np.round(reading / step) * step}
        units = {"joint.command": "V", "joint.angle": "rad"}
        if case.pressures:
            for side in ("pressure_a", "pressure_b"):
                clean = getattr(done, side)
                signals[f"joint.{side}"] = clean + pressure_noise * rng.standard_normal(clean.size)
                units[f"joint.{side}"] = "Pa"
        write_signals(folder / f"{name}.csv", np.arange(done.volts.size) * SAMPLE_S, signals, units)


def labels_of(cases: list[Case]) -> str:
    """The labels as JSON, whose hash is told before anything is diagnosed."""
    return json.dumps([asdict(case) for case in cases], sort_keys=True, indent=1)


def digest(labels: str) -> str:
    """SHA-256 of the labels."""
    return hashlib.sha256(labels.encode()).hexdigest()


def known_effects() -> tuple[str, ...]:
    """Listed effects that a case may conceal."""
    return tuple(LISTED)
