"""Concealed cases: what is concealed in which machine, its recordings, and its label."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.challenge.build import BENCH, Build, build_of
from hydrolek_drake.challenge.driving import SAMPLE_S, Played, random_series
from hydrolek_drake.challenge.listed import LISTED, with_effects
from hydrolek_drake.challenge.running import STEP_S
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.rigs import Rig

TRAIN_S, HOLDOUT_S = 40.0, 30.0


@dataclass(frozen=True)
class Case:
    """One machine and what is concealed in it.

    Attributes:
        name: of its folder.
        kind: one of `drawing.KINDS`.
        size: one of `drawing.SHOWS`, or none for a healthy one.
        drive: open or closed.
        pressures: whether the chamber pressures are recorded.
        effects: listed effects with their parameters.
        unlisted: physics in no list with its numbers.
        stages: where it acts.
        machine: the numbers that differ from the rig's.
        seed: of commands and noise.
        rig: whose machine it is.
        shows: effect -> how many times the noise it shows, beside the other one of a double; empty in old labels.
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
    rig: str = BENCH
    shows: dict[str, float] = field(default_factory=dict)


CASE_KEYS = tuple(each.name for each in fields(Case) if each.name not in ("rig", "shows"))
"""What a label has at least."""


def machine_of(build: Build, case: Case) -> Any:
    """The machine of a case."""
    return with_concealed(build.nominal._replace(**case.machine), case.effects | case.unlisted)


def with_concealed(machine: Any, concealed: Mapping[str, Mapping[str, float]]) -> Any:
    """The machine with listed effects and with physics in no list, whose parameters are fields of `Concealed`."""
    listed = {name: parameters for name, parameters in concealed.items() if name in LISTED}
    strange = {
        p: v for name, parameters in concealed.items() if name not in LISTED for p, v in parameters.items()
    }
    machine = with_effects(machine, listed)
    return machine._replace(concealed=machine.concealed._replace(**strange))


def driven(
    build: Build,
    machine: Any,
    drive: str,
    seconds: float,
    rng: np.random.Generator,
    noise: float,
    step: float = STEP_S,
) -> Played:
    """What a machine does when its driver's commands or a controller's set points are drawn from `rng`.

    Args:
        build: of the machine.
        machine: with what it conceals.
        drive: open or closed.
        seconds: how long.
        rng: of commands, and of the noise that the controller sees.
        noise: standard deviation of the noise that the controller sees [rad].
        step: of the integration [s].
    """
    series = random_series(build.driving, drive == "closed", seconds, rng)
    if drive == "open":
        return build.play(machine, series, step=step)
    return build.play(machine, None, series, noise * rng.standard_normal(series.size), step)


def record(rig: Rig, case: Case, folder: Path) -> None:
    """Write `train.csv` and `holdout.csv` of a case, with the noise and resolution that the rig states."""
    rng = np.random.default_rng(case.seed)
    build = build_of(rig)
    folder.mkdir(parents=True, exist_ok=True)
    machine = machine_of(build, case)
    for name, seconds in (("train", TRAIN_S), ("holdout", HOLDOUT_S)):
        done = driven(build, machine, case.drive, seconds, rng, build.noise)
        write_played(folder / f"{name}.csv", build, done, rng, pressures=case.pressures)


def write_played(
    path: Path,
    build: Build,
    done: Played,
    rng: np.random.Generator,
    *,
    pressures: bool = False,
    begins: float = 0.0,
    gap: tuple[float, float] | None = None,
) -> None:
    """Write what a machine did as its sensors tell it.

    Args:
        path: of the file.
        build: whose rig states noise and resolution.
        done: command and movement.
        rng: of the noise.
        pressures: whether the chamber pressures are told too.
        begins: time of the first sample [s].
        gap: after its begin and until its end [s] no sample was recorded; None for no gap.
    """
    rig, joint = build.rig, build.rig.joints[0]
    resolution = rig.value("sensor.resolution")
    reading = done.reading + build.noise * rng.standard_normal(done.reading.size)
    signals = {
        f"{joint}.command": done.volts,
        f"{joint}.angle": np.round(reading / resolution) * resolution,
    }
    units = {f"{joint}.command": "V", f"{joint}.angle": "rad"}
    for side in ("pressure_a", "pressure_b") if pressures else ():
        clean = getattr(done, side)
        signals[f"{joint}.{side}"] = clean + rig.value("sensor.pressure_noise") * rng.standard_normal(
            clean.size
        )
        units[f"{joint}.{side}"] = "Pa"
    time = np.arange(done.volts.size) * SAMPLE_S
    kept = np.ones(time.size, dtype=bool) if gap is None else (time < gap[0]) | (time > gap[1])
    write_signals(path, begins + time[kept], {key: values[kept] for key, values in signals.items()}, units)


def labels_of(cases: list[Case]) -> str:
    """The labels as JSON, whose hash is told before anything is diagnosed."""
    return json.dumps([asdict(case) for case in cases], sort_keys=True, indent=1)


def read_case(label: Mapping[str, Any]) -> Case:
    """A case from its label; old labels know no rig but the bench."""
    return Case(**{**label, "stages": tuple(label["stages"])})


def digest(labels: str) -> str:
    """SHA-256 of the labels."""
    return hashlib.sha256(labels.encode()).hexdigest()
