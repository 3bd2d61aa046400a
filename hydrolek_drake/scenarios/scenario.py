"""Scenarios: a rig, what it is commanded, how long, from where, and what happens meanwhile.

A scenario is a YAML file; the folder `diagrams` holds those that come with the project:

    schema: 1
    title: one line for people
    rig: hydrolek_right_j2            # name or file, beside the scenario or built in
    settings: {supply.pressure: 12 MPa}                # values of the rig, optional
    duration: 8 s
    command: {kind: constant, joints: {right_j2: 2 V}} # see `commands` for all kinds
    initial_position: {right_j2: 20 deg, right_j3: 0}  # optional; held joints too
    events: {supply_lost_at: 5 s, commands_zero_at: 5 s}   # optional
    integration: {step: 1 ms, plant_step: 0, log_period: 10 ms, integrator: runge_kutta3}  # optional; steps as
                                      # `step_sizes.sizes_for` the rig if not given
    forces: mounts                    # where cylinders push: at their mounts, or as moments on the joints
    noise: false                      # whether the sensors are noisy, optional

Numbers without a unit are in SI.
"""

import copy
import difflib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import hydrolek_drake
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import is_file, named_file
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rigs.machine.rig import declaration
from hydrolek_drake.rigs.parameters.entries import parse_quantity
from hydrolek_drake.rigs.parameters.keys import refuse_unknown
from hydrolek_drake.scenarios.commands import Command, parse_command
from hydrolek_drake.scenarios.fields import quantity, required
from hydrolek_drake.scenarios.set_points import Controlled
from hydrolek_drake.station.step_sizes import StepSizes, sizes_for
from hydrolek_drake.yaml_files import parse_yaml, read_yaml

PREFIX = "scenario."
"""What a setting of the scenario begins with; all others are the rig's."""

_KEYS = (
    "schema", "title", "rig", "settings", "duration", "command", "initial_position", "events",
    "integration", "forces", "noise",
)  # fmt: skip
_SCHEMA = 1
_MOST_ROWS = 2_000_000  # of signals: a gigabyte for each 50 of them
_MOST_STEPS = 1_000_000_000  # a month or so


@dataclass(frozen=True)
class Scenario:
    """A scenario as loaded and checked.

    Attributes:
        name: as used on the command line.
        path: the file it came from.
        title: one line for people.
        rig: the machine, with settings and initial positions.
        duration: [s].
        command: what drives it, or None where controllers do.
        controlled: controllers and their set points, or None.
        operator: whether commands are signals in percent that pass operator computer and field point.
        supply_lost_at: when the supply falls to tank pressure [s], or None.
        commands_zero_at: from when on all commands are zero and set points withdrawn [s], or None.
        sizes: step sizes.
        noise: whether the sensors are noisy.
        tree: the file's content with the settings.
    """

    name: str
    path: Path
    title: str
    rig: Rig
    duration: float
    command: Command | None
    controlled: Controlled | None
    operator: bool
    supply_lost_at: float | None
    commands_zero_at: float | None
    sizes: StepSizes
    noise: bool
    tree: dict[str, Any]

    def command_table(self, seed: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Times [s], shape (m,), and commands [V or %], shape (m, joints), each held until the next."""
        if self.command is None:
            raise ValueError("what controllers command is known after the run only")
        times, values = self.command.table(self.duration, self.sizes.log_period, seed)
        if self.commands_zero_at is None:
            return times, values
        before = times < self.commands_zero_at
        rest = np.zeros(len(self.rig.joints))
        if not self.operator:
            rest = self.rig.records()["command"]["neutral"].astype(float)
        return np.append(times[before], self.commands_zero_at), np.vstack([values[before], rest])


def scenario_files() -> dict[str, Path]:
    """Name and file of every scenario that comes with the project."""
    package = Path(hydrolek_drake.__file__).resolve().parent
    for folder in (package / "diagrams", package.parent / "diagrams"):  # installed; in a clone
        if folder.is_dir():
            return {path.stem: path for path in sorted(folder.glob("*.yaml"))}
    raise InputError(f"there are no scenarios in {package / 'diagrams'} nor beside the package; reinstall")


def load_scenario(name_or_path: str | Path, settings: Mapping[str, str] | None = None) -> Scenario:
    """Load a scenario by its name or from a file.

    Args:
        name_or_path: "gravity_hold", or a path to a YAML file.
        settings: "scenario.duration" -> "5 s" for the scenario, "supply.pressure" -> "12 MPa" for its rig.

    Raises:
        InputError: one line saying which file, key and value is wrong and what would be right.
    """
    path = named_file(name_or_path, scenario_files(), "scenario")
    tree = _read(path)
    rig_settings = {}
    for key, text in (settings or {}).items():
        if key.startswith(PREFIX):
            _apply(tree, key, text)
        else:
            rig_settings[key] = text
    refuse_unknown(tree, _KEYS, str(path))
    if tree.get("schema") != _SCHEMA:
        raise InputError(f"{path}: schema: '{tree.get('schema')}' is unknown; write schema: {_SCHEMA}")
    for key in ("rig", "duration", "command"):
        required(tree, key, str(path))
    rig = _rig(tree, path, rig_settings)
    duration = quantity(tree["duration"], "s", f"{path}: duration", lowest=0.0)
    if duration <= 0.0:
        raise InputError(f"{path}: duration: {duration:g} s must be above 0")
    sizes = _sizes(tree.get("integration") or {}, rig, path)
    _check_length(duration, sizes, path)
    command, operator = parse_command(tree["command"], rig, f"{path}: command", path.parent)
    events = tree.get("events") or {}
    refuse_unknown(events, ("supply_lost_at", "commands_zero_at"), f"{path}: events")
    forces = tree.get("forces", "mounts")
    if forces not in ("mounts", "moments"):
        raise InputError(f"{path}: forces: '{forces}' is unknown; choose mounts or moments")
    noise = tree.get("noise", False)
    if not isinstance(noise, bool):
        raise InputError(f"{path}: noise: '{noise}' is neither true nor false")
    zero_at = _event(events, "commands_zero_at", path)
    controlled = command if isinstance(command, Controlled) else None
    if controlled is not None and zero_at is not None:
        controlled = controlled.until(zero_at)
    return Scenario(
        name=path.stem,
        path=path,
        title=str(tree.get("title", path.stem)),
        rig=rig,
        duration=duration,
        command=None if isinstance(command, Controlled) else command,
        controlled=controlled,
        operator=operator,
        supply_lost_at=_event(events, "supply_lost_at", path),
        commands_zero_at=zero_at,
        sizes=replace(sizes, mount_forces=forces == "mounts"),
        noise=noise,
        tree=tree,
    )


def _read(path: Path) -> dict[str, Any]:
    tree = read_yaml(path, "scenario")
    if not isinstance(tree, dict):
        raise InputError(f"scenario {path} is empty or not a mapping; it needs {', '.join(_KEYS)}")
    return tree


def _apply(tree: dict[str, Any], key: str, text: str) -> None:
    """Write one setting into the tree; what it then says is checked like the file itself."""
    *above, last = key.removeprefix(PREFIX).split(".")
    first = above[0] if above else last
    if first not in _KEYS:
        near = difflib.get_close_matches(first, _KEYS, n=1)
        hint = f" (did you mean {near[0]}?)" if near else ""
        raise InputError(f"--set {key}={text}: unknown key{hint}; a scenario has {', '.join(_KEYS)}")
    node = tree
    for part in above:
        node = node.setdefault(part, {})
        if not isinstance(node, dict):
            raise InputError(f"--set {key}={text}: {part} has no keys below it")
    node[last] = parse_yaml(text, f"--set {key}={text}: the value")


def _rig(tree: dict[str, Any], path: Path, settings: Mapping[str, str]) -> Rig:
    """The rig with the scenario's settings, then the user's, and the initial positions of all joints."""
    beside = path.parent / str(tree["rig"])
    try:
        rig = load_rig(beside if is_file(beside) else str(tree["rig"]))
    except InputError as error:
        raise InputError(f"{path}: rig: {error}") from None
    own = tree.get("settings") or {}
    if not isinstance(own, Mapping):
        raise InputError(f"{path}: settings must be a mapping such as {{supply.pressure: 12 MPa}}")
    positions = tree.get("initial_position") or {}
    if not isinstance(positions, Mapping):
        raise InputError(f"{path}: initial_position must be a mapping such as {{{rig.joints[0]}: 20 deg}}")
    moving, held = {}, dict(rig.held)
    for joint, raw in positions.items():
        where = f"{path}: initial_position.{joint}"
        if joint in rig.joints:
            full = f"joints.{joint}.load.initial_position"
            moving[full] = parse_quantity(str(raw), declaration(rig, full), where)
        elif joint in held:
            held[joint] = quantity(raw, "rad", where)
        else:
            raise InputError(f"{where}: no such joint; choose {', '.join([*rig.joints, *held])}")
    rig = replace(rig, held=copy.deepcopy(held))
    try:
        rig = rig.with_settings({str(key): str(value) for key, value in own.items()})
    except InputError as error:
        raise InputError(f"{path}: settings: {error}") from None
    rig = rig.with_values(moving).with_settings(settings)
    _check_positions(rig, path)
    return rig


def _check_positions(rig: Rig, path: Path) -> None:
    for name, joint in zip(rig.joints, rig.records(), strict=True):
        q, low, high = (float(joint["load"][key]) for key in ("initial_position", "lower_stop", "upper_stop"))
        if not (np.isnan(low) or low <= q <= high):
            if rig.variant(name, "load") == "sliding":
                raise InputError(
                    f"{path}: initial_position.{name}: {q:g} m lies outside its stops, {low:g} to {high:g} m"
                )
            q_deg, low_deg, high_deg = np.degrees([q, low, high])
            raise InputError(
                f"{path}: initial_position.{name}: {q_deg:.4g} deg lies outside its stops, "
                f"{low_deg:.4g} to {high_deg:.4g} deg"
            )


def _event(events: Mapping[str, Any], key: str, path: Path) -> float | None:
    if events.get(key) is None:
        return None
    return quantity(events[key], "s", f"{path}: events.{key}", lowest=0.0)


def _check_length(duration: float, sizes: StepSizes, path: Path) -> None:
    """Refuse a run that would not end, or not fit into memory."""
    limits = (
        ("log_period", _MOST_ROWS, "rows"),
        ("step", _MOST_STEPS, "steps"),
        ("plant_step", _MOST_STEPS, "steps"),
    )
    for key, most, what in limits:
        each = getattr(sizes, key)
        if each > 0.0 and duration / each > most:
            raise InputError(
                f"{path}: duration: {duration:g} s are more than {most} {what} of {each:g} s; "
                f"shorten it, or lengthen integration.{key}"
            )


def _sizes(raw: Any, rig: Rig, path: Path) -> StepSizes:
    where = f"{path}: integration"
    refuse_unknown(raw, ("step", "plant_step", "log_period", "integrator"), where)
    times = {
        key: quantity(raw[key], "s", f"{where}.{key}", lowest=0.0)
        for key in ("step", "plant_step", "log_period")
        if key in raw
    }
    for key in ("step", "log_period"):
        if times.get(key, 1.0) <= 0.0:
            raise InputError(f"{where}.{key}: 0 s is impossible; give a time above 0")
    try:
        usual = sizes_for(rig)
        return StepSizes(
            step=times.get("step", usual.step),
            plant_step=times.get("plant_step", usual.plant_step),
            log_period=times.get("log_period", StepSizes.log_period),
            integrator=str(raw.get("integrator", usual.integrator)),
        )
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
