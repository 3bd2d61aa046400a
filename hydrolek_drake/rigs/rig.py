"""A machine: its joints, stages, parameters and the names of its recordings' columns."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.effects.catalogue import EFFECTS, effect_named
from hydrolek_drake.effects.effect import Effect
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import supply
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.records import JOINT, JOINT_STAGES, SHARED_STAGES
from hydrolek_drake.rigs import geometry
from hydrolek_drake.rigs.entries import Entry, parse_entry, parse_quantity
from hydrolek_drake.rigs.writing import written_tree

LONGEST_STEP = Parameter("longest_step", "s", "upper bound of the rollout's integration step", lowest=1e-9)
SPOOL_STEPS = Parameter("spool_steps", "1", "steps of the spool within one step of the rest", lowest=1.0)


@dataclass(frozen=True)
class Rig:
    """A rig as loaded and checked; `entries` maps each full path to its parameter.

    Attributes:
        name: as used on the command line.
        path: the file it came from.
        title: one line for people.
        joints: names of the moving joints.
        variants: `joints.<joint>.<stage>` or `<stage>` -> name of the chosen variant.
        entries: full path -> parameter.
        held: joints of the arms that stand still -> their position [rad].
        columns: column of a recording -> name of the contract, e.g. "qm" -> "axis.position_m".
        initial_position: "rig", or "recording": where a replay starts.
        tree: the file's content with all it is based on.
    """

    name: str
    path: Path
    title: str
    joints: tuple[str, ...]
    variants: dict[str, str]
    entries: dict[str, Entry]
    held: dict[str, float]
    columns: dict[str, str]
    initial_position: str
    tree: dict[str, Any]

    @classmethod
    def from_tree(cls, tree: dict[str, Any], path: Path) -> "Rig":
        """Check a tree read from `path` and convert it.

        Raises:
            InputError: naming file, key, value and choices.
        """
        variants: dict[str, str] = {}
        entries: dict[str, Entry] = {}
        for name, stage in SHARED_STAGES.items():
            _read_stage(tree.get(name), stage, name, path, variants, entries)
        everywhere = _effects_section(tree, f"{path}: effects")
        for joint, sections in tree["joints"].items():
            for section in sections:
                if section not in JOINT_STAGES and section != "effects":
                    raise InputError(
                        f"{path}: joints.{joint}.{section}: unknown stage; "
                        f"a joint has {', '.join([*JOINT_STAGES, 'effects'])}"
                    )
            for name, stage in JOINT_STAGES.items():
                _read_stage(sections.get(name), stage, f"joints.{joint}.{name}", path, variants, entries)
            _read_effects(
                {**everywhere, **_effects_section(sections, f"{path}: joints.{joint}.effects")},
                f"joints.{joint}.effects",
                path,
                entries,
            )
        integration = tree.get("integration") or {}
        _check_keys(integration, ("longest_step", "spool_steps"), "integration", path)
        for parameter in (LONGEST_STEP, SPOOL_STEPS):
            if parameter.name not in integration:
                raise InputError(f"{path}: integration.{parameter.name} is missing")
            where = f"integration.{parameter.name}"
            entries[where] = parse_entry(integration[parameter.name], parameter, f"{path}: {where}")
        recording = tree.get("recording") or {}
        _check_keys(recording, ("columns", "initial_position"), "recording", path)
        columns = recording.get("columns") or {}
        if not isinstance(columns, Mapping):
            raise InputError(f"{path}: recording.columns must be a mapping, such as {{qm: axis.position_m}}")
        initial = recording.get("initial_position", "rig")
        if initial not in ("rig", "recording"):
            raise InputError(
                f"{path}: recording.initial_position: '{initial}' is unknown; use rig or recording"
            )
        rig = cls(
            name=str(tree.get("name", path.stem)),
            path=path,
            title=str(tree.get("title", "")),
            joints=tuple(tree["joints"]),
            variants=variants,
            entries=entries,
            held=_held(tree, path),
            columns={str(theirs): str(ours) for theirs, ours in columns.items()},
            initial_position=initial,
            tree=tree,
        )
        geometry.check(rig)
        return rig

    def value(self, path: str) -> float:
        """Value of a parameter in SI; `path` as in `full_path`."""
        full = self.full_path(path)
        entry = self.entries[full]
        section, _, name = full.rpartition(".")
        if entry.same_as is not None:
            return self.value(f"{section}.{entry.same_as}")
        if name in geometry.FROM_ARM and math.isnan(entry.value):
            joint = section.split(".")[1]
            return geometry.arm_load(joint, tuple(sorted(self.posture_without(joint).items())))[name]
        return entry.value

    def posture_without(self, joint: str) -> dict[str, float]:
        """Where all other joints stand: held ones, and moving ones at their initial position [rad or m]."""
        moving = {
            name: self.value(f"joints.{name}.load.initial_position") for name in self.joints if name != joint
        }
        return {**self.held, **moving}

    def full_path(self, path: str) -> str:
        """Complete path of a parameter; on a rig with one joint `joints.<joint>.` may be left out.

        Raises:
            InputError: no such parameter; names the nearest ones.
        """
        candidates = [path, *(f"joints.{joint}.{path}" for joint in self.joints if len(self.joints) == 1)]
        for candidate in candidates:
            if candidate in self.entries:
                return candidate
        near = difflib.get_close_matches(path, self.entries, n=3, cutoff=0.3)
        raise InputError(f"rig {self.name} has no parameter '{path}'; nearest: {', '.join(near) or 'none'}")

    def variant(self, joint: str, stage: str) -> str:
        """The chosen variant of a stage."""
        return self.variants[stage if stage in SHARED_STAGES else f"joints.{joint}.{stage}"]

    def with_values(self, values: Mapping[str, float]) -> "Rig":
        """A copy with other values (SI); a parameter that followed another one no longer does."""
        entries = dict(self.entries)
        for path, value in values.items():
            full = self.full_path(path)
            entries[full] = replace(entries[full], value=float(value), same_as=None)
        rig = replace(self, entries=entries)
        geometry.check(rig)
        return rig

    def with_settings(self, settings: Mapping[str, str]) -> "Rig":
        """A copy with values given as text, as `--set path=value` does ("12 MPa", or SI without a unit).

        Raises:
            InputError: unknown path, wrong unit, impossible value.
        """
        values = {}
        for path, text in settings.items():
            full = self.full_path(path)
            values[full] = parse_quantity(text, declaration(self, full), f"--set {path}={text}")
        return self.with_values(values)

    def owner(self, effect: Effect, joint: str) -> str:
        """The joint whose parameters of an effect act on `joint`: all share the pump, so the first joint has those."""
        return self.joints[0] if effect.stage == supply.STAGE.name else joint

    def effects_on(self, joint: str) -> tuple[str, ...]:
        """Ids of the effects that are switched on at a joint."""
        return tuple(
            effect.id
            for effect in EFFECTS.values()
            if self.value(f"joints.{self.owner(effect, joint)}.effects.{effect.id}.{effect.size}")
            != effect.neutral_size
        )

    def free_parameters(self) -> dict[str, Entry]:
        """Parameters that have a range and do not follow another one."""
        return {
            path: entry
            for path, entry in self.entries.items()
            if entry.range is not None and entry.same_as is None
        }

    def records(self) -> np.ndarray:
        """The joints' parameter records, shape (n joints,), dtype `physics.records.JOINT`.

        Effects on the supply, which all joints share, are the first joint's.
        """
        records = np.zeros(len(self.joints), JOINT)
        for i, joint in enumerate(self.joints):
            for name, stage in {**SHARED_STAGES, **JOINT_STAGES}.items():
                where = name if name in SHARED_STAGES else f"joints.{joint}.{name}"
                _fill(records[i][name], stage, where, self)
            for effect in EFFECTS.values():
                owner = self.owner(effect, joint)
                for p in effect.parameters:
                    records[i]["effects"][effect.key][p.name] = self.value(
                        f"joints.{owner}.effects.{effect.id}.{p.name}"
                    )
        return records

    def as_tree(self) -> dict[str, Any]:
        """The rig as a tree that can be written as a file and loads to the same rig."""
        return written_tree(self)


def declaration(rig: Rig, full_path: str) -> Parameter:
    """What is declared about a parameter: unit, meaning, bounds."""
    if full_path.startswith("integration."):
        return LONGEST_STEP if full_path.endswith("longest_step") else SPOOL_STEPS
    section, _, name = full_path.rpartition(".")
    if ".effects." in section:
        effect = effect_named(section.split(".effects.")[1])
        return next(p for p in effect.parameters if p.name == name)
    stage = {**SHARED_STAGES, **JOINT_STAGES}[section.split(".")[-1]]
    return next(p for p in stage.parameters(rig.variants[section]) if p.name == name)


def _check_keys(section: Any, allowed: tuple[str, ...], where: str, path: Path) -> None:
    if not isinstance(section, Mapping):
        raise InputError(f"{path}: {where} must be a mapping with {', '.join(allowed)}")
    for key in section:
        if key not in allowed:
            near = difflib.get_close_matches(str(key), allowed, n=1)
            hint = f" (did you mean {near[0]}?)" if near else ""
            raise InputError(f"{path}: {where}.{key}: unknown key{hint}; there are {', '.join(allowed)}")


def _read_stage(
    section: Any, stage: Stage, where: str, path: Path, variants: dict[str, str], entries: dict[str, Entry]
) -> None:
    if section is None:
        section = {}
    if not isinstance(section, Mapping):
        raise InputError(f"{path}: {where} must be a mapping of parameters")
    choices = tuple(stage.variants)
    plain = (
        choices[0] if not stage.variants[choices[0]] else None
    )  # the variant that needs nothing of its own
    variant = section.get("variant", plain)
    if variant not in choices:
        said = "is missing" if variant is None else f"'{variant}' is unknown"
        raise InputError(f"{path}: {where}.variant {said}; choose {', '.join(choices)}")
    variants[where] = variant
    parameters = stage.parameters(variant)
    _check_keys(section, ("variant", *(p.name for p in parameters)), where, path)
    for p in parameters:
        full = f"{where}.{p.name}"
        if p.name in section:
            entries[full] = parse_entry(section[p.name], p, f"{path}: {full}")
        elif variant == "arm" and p.name in geometry.FROM_ARM:
            continue
        elif p.neutral is not None:
            entries[full] = Entry(p.neutral, p.unit, "neutral: not part of this machine")
        else:
            raise InputError(f"{path}: {full} is missing: {p.meaning} [{p.unit}]")
    if variant == "arm":
        units = {p.name: p.unit for p in parameters}
        for name, entry in geometry.arm_entries().items():
            entries.setdefault(f"{where}.{name}", replace(entry, unit=units[name]))
    _check_same_as(where, tuple(p.name for p in parameters), path, entries)


def _check_same_as(where: str, names: tuple[str, ...], path: Path, entries: dict[str, Entry]) -> None:
    for name in names:
        followed = [name]
        while (other := entries[f"{where}.{followed[-1]}"].same_as) is not None:
            full = f"{where}.{followed[-1]}.same_as"
            if other not in names or other == followed[-1]:
                raise InputError(f"{path}: {full}: no other parameter '{other}' in this section")
            if other in followed:
                raise InputError(f"{path}: {full}: '{other}' goes in a circle")
            followed.append(other)


def _effects_section(sections: Mapping[str, Any], where: str) -> Mapping[str, Any]:
    section = sections.get("effects") or {}
    if not isinstance(section, Mapping):
        raise InputError(f"{where} must be a mapping of effects, such as {{command.delay: {{delay_s: ...}}}}")
    return section


def _read_effects(section: Mapping[str, Any], where: str, path: Path, entries: dict[str, Entry]) -> None:
    for effect_id in section:
        if effect_id not in EFFECTS:
            try:
                effect_named(str(effect_id))
            except InputError as error:
                raise InputError(f"{path}: {where}: {error}") from None
    for effect in EFFECTS.values():
        given = section.get(effect.id) or {}
        _check_keys(given, tuple(p.name for p in effect.parameters), f"{where}.{effect.id}", path)
        for p in effect.parameters:
            full = f"{where}.{effect.id}.{p.name}"
            if p.name in given:
                entries[full] = parse_entry(given[p.name], p, f"{path}: {full}")
            else:
                entries[full] = Entry(float(p.neutral or 0.0), p.unit, "neutral: effect is off")
        _check_same_as(f"{where}.{effect.id}", tuple(p.name for p in effect.parameters), path, entries)


def _fill(record: Any, stage: Stage, where: str, rig: Rig) -> None:
    variant = rig.variants[where]
    record["variant"] = stage.code(variant)
    own = {p.name for p in stage.parameters(variant)}
    for p in {p.name: p for v in stage.variants for p in stage.parameters(v)}.values():
        unused = np.nan if p.neutral is None else p.neutral
        record[p.name] = rig.value(f"{where}.{p.name}") if p.name in own else unused


def _held(tree: dict[str, Any], path: Path) -> dict[str, float]:
    held = {}
    for joint, sections in (tree.get("_held") or {}).items():
        load = sections.get("load")
        stage = JOINT_STAGES["load"]
        where = f"{path}: joints.{joint}.load"
        if not isinstance(load, Mapping) or load.get("variant") not in tuple(stage.variants):
            raise InputError(f"{where}.variant is missing or unknown; choose {', '.join(stage.variants)}")
        parameter = next(p for p in stage.parameters(load["variant"]) if p.name == "initial_position")
        held[joint] = parse_entry(load.get("initial_position"), parameter, f"{where}.initial_position").value
    return held
