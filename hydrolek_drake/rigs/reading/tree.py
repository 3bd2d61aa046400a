"""A rig read from the tree of its file: every key checked, every number in SI."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from hydrolek_drake.effects.catalogue import EFFECTS, effect_named
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.parameters import Stage
from hydrolek_drake.physics.records import JOINT_STAGES, SHARED_STAGES
from hydrolek_drake.rigs.checks import across
from hydrolek_drake.rigs.machine.driven_by import read_driven_by
from hydrolek_drake.rigs.machine.rig import Rig
from hydrolek_drake.rigs.machine.short_law import LawTerm, read_law
from hydrolek_drake.rigs.parameters.arm_loads import FROM_ARM, arm_entries
from hydrolek_drake.rigs.parameters.declarations import OF_INTEGRATION, at_joint
from hydrolek_drake.rigs.parameters.entries import Entry, parse_entry
from hydrolek_drake.rigs.parameters.keys import refuse_unknown


def rig_from_tree(tree: dict[str, Any], path: Path) -> Rig:
    """Check a tree read from `path` and convert it.

    Raises:
        InputError: naming file, key, value and choices.
    """
    variants: dict[str, str] = {}
    entries: dict[str, Entry] = {}
    laws: dict[str, tuple[LawTerm, ...]] = {}
    for name, stage in SHARED_STAGES.items():
        _read_stage(tree.get(name), stage, name, path, variants, entries)
    everywhere = _effects_section(tree, f"{path}: effects")
    for joint, sections in tree["joints"].items():
        for section in sections:
            if section not in JOINT_STAGES and section not in ("effects", "law"):
                raise InputError(
                    f"{path}: joints.{joint}.{section}: unknown stage; "
                    f"a joint has {', '.join([*JOINT_STAGES, 'effects', 'law'])}"
                )
        for name, stage in JOINT_STAGES.items():
            _read_stage(sections.get(name), stage, f"joints.{joint}.{name}", path, variants, entries)
        _read_effects(
            {**everywhere, **_effects_section(sections, f"{path}: joints.{joint}.effects")},
            f"joints.{joint}",
            path,
            variants,
            entries,
        )
        if law := read_law(sections.get("law"), f"joints.{joint}.law", path):
            laws[joint] = law
    integration = tree.get("integration") or {}
    refuse_unknown(integration, tuple(p.name for p in OF_INTEGRATION), f"{path}: integration")
    for parameter in OF_INTEGRATION:
        where = f"integration.{parameter.name}"
        if parameter.name in integration:
            entries[where] = parse_entry(integration[parameter.name], parameter, f"{path}: {where}")
        elif parameter.neutral is not None:
            entries[where] = Entry(parameter.neutral, parameter.unit, "neutral: not part of this machine")
        else:
            raise InputError(f"{path}: {where} is missing")
    recording = tree.get("recording") or {}
    refuse_unknown(recording, ("columns", "initial_position", "driven_by"), f"{path}: recording")
    columns = recording.get("columns") or {}
    if not isinstance(columns, Mapping):
        raise InputError(f"{path}: recording.columns must be a mapping, such as {{qm: axis.position_m}}")
    initial = recording.get("initial_position", "rig")
    if initial not in ("rig", "recording"):
        raise InputError(f"{path}: recording.initial_position: '{initial}' is unknown; use rig or recording")
    rig = Rig(
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
        laws=laws,
        driven_by=read_driven_by(recording.get("driven_by"), tuple(tree["joints"]), variants, path),
    )
    across.check(rig)
    return rig


def _read_stage(
    section: Any, stage: Stage, where: str, path: Path, variants: dict[str, str], entries: dict[str, Entry]
) -> None:
    if section is None:
        section = {}
    if not isinstance(section, Mapping):
        raise InputError(f"{path}: {where} must be a mapping of parameters")
    choices = tuple(stage.variants)
    plain = stage.default or (choices[0] if not stage.variants[choices[0]] else None)
    variant = section.get("variant", plain)
    if variant not in choices:
        said = "is missing" if variant is None else f"'{variant}' is unknown"
        raise InputError(f"{path}: {where}.variant {said}; choose {', '.join(choices)}")
    variants[where] = variant
    parameters = stage.parameters(variant)
    refuse_unknown(section, ("variant", *(p.name for p in parameters)), f"{path}: {where}")
    for p in parameters:
        full = f"{where}.{p.name}"
        if p.name in section:
            entries[full] = parse_entry(section[p.name], p, f"{path}: {full}")
        elif variant == "arm" and p.name in FROM_ARM:
            continue
        elif p.neutral is not None:
            entries[full] = Entry(p.neutral, p.unit, "neutral: not part of this machine")
        else:
            raise InputError(f"{path}: {full} is missing: {p.meaning} [{p.unit}]")
    if variant == "arm":
        units = {p.name: p.unit for p in parameters}
        for name, entry in arm_entries().items():
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


def _read_effects(
    section: Mapping[str, Any],
    joint: str,
    path: Path,
    variants: Mapping[str, str],
    entries: dict[str, Entry],
) -> None:
    where = f"{joint}.effects"
    for effect_id in section:
        if effect_id not in EFFECTS:
            try:
                effect_named(str(effect_id))
            except InputError as error:
                raise InputError(f"{path}: {where}: {error}") from None
    for effect in EFFECTS.values():
        given = section.get(effect.id) or {}
        refuse_unknown(given, tuple(p.name for p in effect.parameters), f"{path}: {where}.{effect.id}")
        for declared in effect.parameters:
            p = at_joint(declared, effect, joint, variants)
            full = f"{where}.{effect.id}.{p.name}"
            if p.name in given:
                entries[full] = parse_entry(given[p.name], p, f"{path}: {full}")
            else:
                entries[full] = Entry(float(p.neutral or 0.0), p.unit.split("|")[0], "neutral: effect is off")
        _check_same_as(f"{where}.{effect.id}", tuple(p.name for p in effect.parameters), path, entries)


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
