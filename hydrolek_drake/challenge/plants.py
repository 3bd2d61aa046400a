"""Concealed cases that are not drawn: other people's machines, as FMUs, with what each conceals."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.challenge.drawing import SHOWS
from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.errors import InputError
from hydrolek_drake.fmu.foreign import AT_MOST_S, read_unit
from hydrolek_drake.fmu.recording import Sensors, record_unit, sensors_of
from hydrolek_drake.physics.records import STAGES
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.recordings.columns import parse_column
from hydrolek_drake.recordings.writing import write_recording
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.yaml_files import read_yaml

SIDES = ("train", "holdout")

_NEEDED = {"fmu": str, "rig": str, "train": str, "holdout": str}
_OPTIONAL = {
    "conceals": dict,
    "stage": str,
    "size": str,
    "map": dict,
    "noise": dict,
    "resolution": dict,
    "set": dict,
    "seed": int,
    "at_most": float,
}


@dataclass(frozen=True)
class Plant:
    """A machine that is an FMU.

    Attributes:
        label: what is concealed in it, as of a case, with digests of its files.
        rig: that the diagnosis is given.
        unit: its file.
        commands: train and holdout -> recording of its commands.
        mapping: variable -> signal with its unit.
        sensors: what they add.
        start: variable -> value before it begins.
        seed: of the noise.
        at_most: how long a run may take [s].
    """

    label: dict[str, Any]
    rig: Rig
    unit: Path
    commands: dict[str, Path]
    mapping: dict[str, str]
    sensors: Sensors
    start: dict[str, float]
    seed: int
    at_most: float


def read_plants(path: Path) -> dict[str, Plant]:
    """Plants of a YAML file, by name; paths in it are relative to it.

    Raises:
        InputError: the file, or a rig that it names, cannot be read, or an entry is wrong.
    """
    content = read_yaml(path, "list of plants")
    cases = content.get("cases") if isinstance(content, dict) else None
    if not isinstance(cases, dict) or not cases:
        raise InputError(
            f"{path}: 'cases' is missing: name of a case -> fmu, rig, train, holdout, conceals ..."
        )
    return {
        str(name): _plant(f"{path}: cases.{name}", str(name), entry, path.parent)
        for name, entry in cases.items()
    }


def record_plant(plant: Plant, folder: Path) -> None:
    """Write `train.csv` and `holdout.csv` of a plant.

    Raises:
        InputError: it cannot be run or recorded.
    """
    rng = np.random.default_rng(plant.seed)
    unit = read_unit(plant.unit)
    folder.mkdir(parents=True, exist_ok=True)
    for side in SIDES:
        made = record_unit(
            unit,
            read_recording(plant.commands[side], plant.rig.columns),
            rng,
            mapping=plant.mapping,
            rig=plant.rig,
            sensors=plant.sensors,
            start=plant.start,
            at_most=plant.at_most,
        )
        write_recording(made, folder / f"{side}.csv")


def _plant(where: str, name: str, entry: Any, folder: Path) -> Plant:
    if not name.isidentifier():
        raise InputError(f"{where}: letters, digits and _ make a name, which is a folder's too")
    given = _checked(where, entry)
    rig = load_rig(str(folder / given["rig"]) if (folder / given["rig"]).exists() else given["rig"], {})
    own = sensors_of(rig)
    sizes, steps = (_sizes(f"{where}.{key}", given.get(key, {})) for key in ("noise", "resolution"))
    files = {side: folder / given[side] for side in SIDES}
    unit = folder / given["fmu"]
    label = _label(where, name, given) | {"rig": rig.name}
    label["files"] = [_digest(where, file) for file in (unit, rig.path, *files.values())]
    mapping = {str(key): str(value) for key, value in given.get("map", {}).items()}
    label["given"] = {"map": mapping, "noise": sizes, "resolution": steps, "seed": given.get("seed", 0)}
    start = {str(key): _number(f"{where}.set.{key}", value) for key, value in given.get("set", {}).items()}
    label["given"]["set"] = start
    label["pressures"] = any("pressure_" in signal for signal in mapping.values())
    return Plant(
        label,
        rig,
        unit,
        files,
        mapping,
        Sensors({**own.noise, **sizes}, {**own.resolution, **steps}),
        start,
        given.get("seed", 0),
        _number(f"{where}.at_most", given.get("at_most", AT_MOST_S)),
    )


def _checked(where: str, entry: Any) -> dict[str, Any]:
    if not isinstance(entry, dict):
        raise InputError(f"{where}: a mapping is needed, with {', '.join(_NEEDED)}")
    known = _NEEDED | _OPTIONAL
    for key, value in entry.items():
        if key not in known:
            raise InputError(f"{where}: '{key}' is not known; write {', '.join(known)}")
        kinds = (int, float) if known[key] is float else known[key]
        if not isinstance(value, kinds) or isinstance(value, bool):
            raise InputError(
                f"{where}.{key}: {value!r} is no {'mapping' if known[key] is dict else known[key].__name__}"
            )
    missing = [key for key in _NEEDED if key not in entry]
    if missing:
        raise InputError(f"{where}: {', '.join(missing)} is missing")
    return entry


def _label(where: str, name: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """What is concealed, as scores read it."""
    conceals = {str(key): value or {} for key, value in given.get("conceals", {}).items()}
    for key, value in conceals.items():
        if not isinstance(value, dict):
            raise InputError(
                f"{where}.conceals.{key}: known parameters of the effect as a mapping are needed, or {{}}"
            )
    effects = {key: value for key, value in conceals.items() if key in EFFECTS}
    strange = {key: value for key, value in conceals.items() if key not in EFFECTS}
    for key, parameters in effects.items():
        known = {p.name for p in EFFECTS[key].parameters}
        for parameter, value in parameters.items():
            _number(f"{where}.conceals.{key}.{parameter}", value)
            if parameter not in known:
                raise InputError(
                    f"{where}.conceals.{key}: no parameter '{parameter}'; it has {', '.join(known)}"
                )
    stages = [EFFECTS[key].stage for key in effects]
    if strange:
        stage = given.get("stage")
        if stage not in STAGES:
            raise InputError(
                f"{where}: {', '.join(strange)} is in no list, so 'stage' must say where it acts: {', '.join(STAGES)}"
            )
        stages.insert(0, stage)
    size = given.get("size", "middle" if conceals else "")
    if size not in (*SHOWS, ""):
        raise InputError(f"{where}.size: {size}: choose {', '.join(SHOWS)}")
    kind = "unlisted" if strange else ("healthy", "single", "double")[min(len(effects), 2)]
    return {
        "name": name,
        "kind": kind,
        "size": size,
        "drive": "open",
        "effects": effects,
        "unlisted": strange,
        "stages": stages,
    }


def _sizes(where: str, given: Mapping[Any, Any]) -> dict[str, float]:
    """Signal -> size in SI, from names with units."""
    found = {}
    for name, value in given.items():
        understood = parse_column(str(name))
        if understood is None:
            raise InputError(f"{where}: '{name}' is no <joint>.<quantity>_<unit>, such as boom.angle_deg")
        found[understood.key] = _number(f"{where}.{name}", value) * understood.factor
    return found


def _number(where: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        raise InputError(f"{where}: {value!r} is no number")
    return float(value)


def _digest(where: str, path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"{where}: {path} cannot be read: {error.strerror or error}") from None
