"""Foreign machines drawn: numbers, data sheets that are wrong, what is concealed, and their recordings."""

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.challenge.foreign.building import built, noises, numbers
from hydrolek_drake.challenge.foreign.concealing import can_have, sized
from hydrolek_drake.challenge.foreign.driving import driven
from hydrolek_drake.challenge.foreign.equations import SAMPLE_S
from hydrolek_drake.challenge.foreign.plant import Plant
from hydrolek_drake.challenge.foreign.sheets import data_sheet
from hydrolek_drake.recordings import write_signals

SIDES = {"train": 40.0, "holdout": 30.0}
"""Recording -> how long it is [s]."""


@dataclass(frozen=True)
class Foreign:
    """One machine with one thing concealed, or nothing.

    Attributes:
        name: of its folder.
        kind: of machine.
        drive: open or closed.
        pressures: whether chamber pressures are recorded; a pump's line is then recorded too.
        conceals: effect -> fields of `Plant`; empty for a healthy one.
        shows: how many times the noise the recorded signals change by it.
        plant: its numbers.
        sheet: options of `hydrolek rig new`.
        wrong: number of the data sheet -> how many times the true one it says.
        seed: of commands and noise.
    """

    name: str
    kind: str
    drive: str
    pressures: bool
    conceals: dict[str, dict[str, float]]
    shows: float
    plant: dict[str, Any]
    sheet: dict[str, str]
    wrong: dict[str, float]
    seed: int


def draw_foreign(count: int, seed: int) -> list[Foreign]:
    """Cases of so many machines: each healthy in open and in closed loop, and with two things concealed.

    Args:
        count: how many machines.
        seed: of everything random.
    """
    rng = np.random.default_rng(seed)
    own = numbers()
    kinds = list(own["kinds"])
    effects: list[str] = []
    cases = []
    for number in range(1, count + 1):
        kind = kinds[(number - 1) % len(kinds)]
        base, plant = built(own, kind, rng)
        pressures = bool(rng.random() < 0.8)
        sheet, wrong = data_sheet(own, base, rng)
        for part in range(4):
            name = f"m{number:02d}_{'abcd'[part]}"
            drive = ("open", "closed")[part % 2]
            case_seed = int(rng.integers(2**31))
            concealed: dict[str, dict[str, float]] = {}
            shows = 0.0
            if part >= 2:
                while True:
                    if not effects:
                        effects = [str(each) for each in rng.permutation(list(own["effects"]))]
                    effect = next((each for each in effects if can_have(base, each)), None)
                    if effect is None:
                        effects = []
                        continue
                    effects.remove(effect)
                    found = sized(own, base, plant, effect, drive, SIDES["train"], pressures, case_seed, rng)
                    if found is not None:
                        concealed, shows = {effect: found[0]}, found[1]
                        break
            cases.append(
                Foreign(
                    name, kind, drive, pressures, concealed, shows, plant._asdict(), sheet, wrong, case_seed
                )
            )
    return cases


def labels_of(cases: list[Foreign]) -> str:
    """The labels as JSON."""
    return json.dumps([asdict(case) for case in cases], sort_keys=True, indent=1)


def digest(labels: str) -> str:
    """SHA-256 of the labels."""
    return hashlib.sha256(labels.encode()).hexdigest()


def record(case: Foreign, folder: Path) -> None:
    """Write `train.csv` and `holdout.csv` of a case."""
    own = numbers()
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(case.seed)
    turns = case.plant["turns"] > 0.5
    plant = plant_of(case)
    noise, pressure_noise = noises(own, turns)
    for name, seconds in SIDES.items():
        done = driven(own, case.kind, plant, case.drive, seconds, rng, noise)
        n = done.volts.size
        signals = {
            "joint.command": done.volts,
            ("joint.angle" if turns else "joint.position"): done.reading + noise * rng.standard_normal(n),
        }
        units = {"joint.command": "V", "joint.angle": "rad", "joint.position": "m"}
        if case.pressures:
            recorded = {"joint.pressure_a": done.pressure_a, "joint.pressure_b": done.pressure_b}
            if plant.pumped > 0.5:
                recorded["supply.pressure"] = done.supply
            for key, clean in recorded.items():
                signals[key] = clean + pressure_noise * rng.standard_normal(n)
                units[key] = "Pa"
        given = {key: units[key] for key in signals}
        write_signals(folder / f"{name}.csv", np.arange(n) * SAMPLE_S, signals, given)


def plant_of(case: Foreign) -> Plant:
    """The machine with what it conceals."""
    told = {**case.plant, "width": tuple(case.plant["width"])}
    for extra in case.conceals.values():
        told.update(extra)
    return Plant(**told)
