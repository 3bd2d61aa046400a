"""A machine: its joints, stages, parameters and the names of its recordings' columns."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.effects.effect import Effect
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import supply
from hydrolek_drake.physics.cylinder import ELECTRIC
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.records import JOINT, JOINT_STAGES, SHARED_STAGES
from hydrolek_drake.rigs.checks import across
from hydrolek_drake.rigs.machine.driven_by import counts, signals_of
from hydrolek_drake.rigs.machine.short_law import LawTerm, law_record
from hydrolek_drake.rigs.machine.writing import written_tree
from hydrolek_drake.rigs.parameters.arm_loads import FROM_ARM, arm_load
from hydrolek_drake.rigs.parameters.declarations import declared
from hydrolek_drake.rigs.parameters.entries import Entry, parse_quantity


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
        laws: joint -> terms of a law for physics in no list; joints without one are left out.
        driven_by: recorded signals that drive the model in place of a part of it, such as `supply.pressure`.
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
    laws: dict[str, tuple[LawTerm, ...]] = field(default_factory=dict)
    driven_by: tuple[str, ...] = ()

    def value(self, path: str) -> float:
        """Value of a parameter in SI; `path` as in `full_path`."""
        full = self.full_path(path)
        entry = self.entries[full]
        section, _, name = full.rpartition(".")
        if entry.same_as is not None:
            return self.value(f"{section}.{entry.same_as}")
        if name in FROM_ARM and math.isnan(entry.value):
            joint = section.split(".")[1]
            return arm_load(joint, tuple(sorted(self.posture_without(joint).items())))[name]
        return entry.value

    @property
    def dead_time(self) -> float:
        """The longest dead time of a joint's command [s]."""
        return max(self.value(f"joints.{joint}.command.delay") for joint in self.joints)

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

    def tells_current(self, joint: str) -> bool:
        """Whether a motor's current is what its drive makes of a commanded position, and so tells something."""
        return self.variant(joint, "cylinder") == "servo_screw"

    def is_hydraulic(self, joint: str) -> bool:
        """Whether oil moves a joint."""
        return self.variant(joint, "cylinder") not in ELECTRIC

    def with_values(self, values: Mapping[str, float]) -> "Rig":
        """A copy with other values (SI); a parameter that followed another one no longer does."""
        entries = dict(self.entries)
        for path, value in values.items():
            full = self.full_path(path)
            entries[full] = replace(entries[full], value=float(value), same_as=None)
        rig = replace(self, entries=entries)
        across.check(rig)
        return rig

    def with_settings(self, settings: Mapping[str, str]) -> "Rig":
        """A copy with values given as text, as `--set path=value` does ("12 MPa", or SI without a unit).

        Raises:
            InputError: unknown path, wrong unit, impossible value.
        """
        values = {}
        for path, text in settings.items():
            full = self.full_path(path)
            values[full] = parse_quantity(text, declared(full, self.variants), f"--set {path}={text}")
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
        """Parameters that have a range, do not follow another one, and are of no part that a recording replaces."""
        return {
            path: entry
            for path, entry in self.entries.items()
            if entry.range is not None and entry.same_as is None and counts(path, self.driven_by, self.joints)
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
            records[i]["law"] = law_record(self.laws.get(joint, ()))
            for part in signals_of(self.driven_by, joint):
                records[i]["driven"][part] = 1.0
        return records

    def by_itself(self) -> "Rig":
        """The rig with no recorded signal in place of a part of it."""
        return replace(self, driven_by=())

    def needs_command(self, joint: str) -> bool:
        """Whether a joint moves by its command: it is driven neither by its spool nor by its chambers' pressures."""
        return not {"spool_position", "chamber_pressures"} & set(signals_of(self.driven_by, joint))

    def as_tree(self) -> dict[str, Any]:
        """The rig as a tree that can be written as a file and loads to the same rig."""
        return written_tree(self.tree, self.entries, self.variants, self.joints, self.laws)


def declaration(rig: Rig, full_path: str) -> Parameter:
    """What is declared about a parameter: unit, meaning, bounds."""
    return declared(full_path, rig.variants)


def _fill(record: Any, stage: Stage, where: str, rig: Rig) -> None:
    variant = rig.variants[where]
    record["variant"] = stage.code(variant)
    own = {p.name for p in stage.parameters(variant)}
    for p in {p.name: p for v in stage.variants for p in stage.parameters(v)}.values():
        unused = np.nan if p.neutral is None else p.neutral
        record[p.name] = rig.value(f"{where}.{p.name}") if p.name in own else unused
