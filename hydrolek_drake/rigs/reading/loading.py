"""Reading rig files: built in by name, or a user's own path; one rig may be based on another."""

import copy
import re
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import is_file, named_file
from hydrolek_drake.physics.records import SHARED_STAGES
from hydrolek_drake.rigs.machine.rig import Rig
from hydrolek_drake.rigs.reading.parts import with_parts
from hydrolek_drake.rigs.reading.tree import rig_from_tree
from hydrolek_drake.yaml_files import read_yaml

_TOP_KEYS = (
    "schema", "name", "title", "source", "based_on", "keep",
    *SHARED_STAGES, "joints", "effects", "recording", "integration",
)  # fmt: skip

SCHEMA = 1
MOST_JOINTS = 64
_NAME = re.compile(r"\w[\w -]{0,63}")  # of a joint: it becomes part of columns and file names
_MOST_FILES = 16  # that are based on each other


def built_in_rigs() -> dict[str, Path]:
    """Name and file of every built-in rig."""
    folder = Path(str(resources.files("hydrolek_drake.rigs")))
    return {path.stem: path for path in sorted(folder.glob("*.yaml"))}


def built_in_titles() -> dict[str, str]:
    """Name and title of every built-in rig, which is not loaded for that."""
    return {name: str(_read(path)["title"]) for name, path in built_in_rigs().items()}


def load_rig(name_or_path: str | Path, settings: Mapping[str, str] | None = None) -> Rig:
    """Load a rig by its built-in name or from a file.

    Args:
        name_or_path: "joint_bench", or a path to a YAML file.
        settings: path in the rig -> value, as given with `--set`.

    Raises:
        InputError: one line saying which file, key and value is wrong and what would be right.
    """
    path = named_file(name_or_path, built_in_rigs(), "rig")
    rig = rig_from_tree(_resolve(path, ()), path)
    return rig.with_settings(settings) if settings else rig


def _read(path: Path) -> dict[str, Any]:
    tree = read_yaml(path, "rig file")
    if not isinstance(tree, dict):
        raise InputError(f"rig file {path} is empty or not a mapping; it needs {', '.join(_TOP_KEYS)}")
    for key in tree:
        if key not in _TOP_KEYS:
            raise InputError(f"{path}: unknown key '{key}'; a rig has {', '.join(_TOP_KEYS)}")
    if tree.get("schema", SCHEMA) != SCHEMA:
        raise InputError(f"{path}: schema {tree['schema']} is not known to this version; use {SCHEMA}")
    return tree


def _resolve(path: Path, seen: tuple[Path, ...]) -> dict[str, Any]:
    """The rig's tree with everything it is based on merged in."""
    if path.resolve() in seen:
        raise InputError(f"{path}: based_on goes in a circle")
    if len(seen) >= _MOST_FILES:
        raise InputError(f"{path}: more than {_MOST_FILES} files that are based on each other")
    tree = with_parts(_read(path), path, _merged)
    base = tree.pop("based_on", None)
    if base is not None:
        beside = path.parent / f"{base}"
        try:
            other = beside if is_file(beside) else named_file(str(base), built_in_rigs(), "rig")
        except InputError as error:
            raise InputError(f"{path}: based_on: {error}") from None
        tree = _merged(_resolve(other, (*seen, path.resolve())), tree)
    keep = tree.pop("keep", None)
    joints = tree.get("joints")
    if not isinstance(joints, dict) or not joints:
        raise InputError(f"{path}: 'joints' is missing; a rig needs at least one joint")
    if len(joints) > MOST_JOINTS:
        raise InputError(f"{path}: {len(joints)} joints; a rig has at most {MOST_JOINTS}")
    for name in joints:
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise InputError(
                f"{path}: joints: '{name}' is not a name; use letters, digits and _ or -, such as right_j2"
            )
    tree["joints"] = {name: _like(name, joints, path, ()) for name in joints}
    if keep is not None:
        if not isinstance(keep, list) or not keep:
            raise InputError(f"{path}: keep: '{keep}' must be a list of joints, of {', '.join(joints)}")
        for name in keep:
            if not isinstance(name, str) or name not in joints:
                raise InputError(f"{path}: keep: no joint '{name}'; there are {', '.join(joints)}")
        held = tree.setdefault("_held", {})
        held.update({name: tree["joints"][name] for name in joints if name not in keep})
        tree["joints"] = {name: tree["joints"][name] for name in keep}
    return tree


def _like(name: str, joints: Mapping[str, Any], path: Path, seen: tuple[str, ...]) -> dict[str, Any]:
    """A joint with everything of the joint that it is `like`."""
    joint = joints[name]
    if not isinstance(joint, dict):
        raise InputError(f"{path}: joints.{name} must be a mapping of stages")
    if "like" not in joint:
        return copy.deepcopy(joint)
    other = joint["like"]
    if not isinstance(other, str) or other not in joints:
        raise InputError(f"{path}: joints.{name}.like: no joint '{other}'; there are {', '.join(joints)}")
    if other in seen:
        raise InputError(f"{path}: joints.{name}.like goes in a circle")
    own = {key: value for key, value in joint.items() if key != "like"}
    return _merged(_like(other, joints, path, (*seen, name)), own)


_PARAMETER_KEYS = {"value", "unit", "source", "range", "scale", "same_as", "note"}


def _merged(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    """`base` with `over` written on top; a parameter or another variant replaces, a section merges."""
    result = copy.deepcopy(base)
    for key, value in over.items():
        old = result.get(key)
        if isinstance(value, dict) and isinstance(old, dict) and not (value.keys() & {"value", "same_as"}):
            other_variant = "variant" in value and value["variant"] != old.get("variant")
            result[key] = copy.deepcopy(value) if other_variant else _merged(old, value)
        elif (
            isinstance(value, dict)
            and isinstance(old, dict)
            and "value" in value
            and old.keys() <= _PARAMETER_KEYS
        ):
            kept = {k: v for k, v in old.items() if k not in ("same_as",)}
            result[key] = {**kept, **value} if value.get("unit") == old.get("unit") else copy.deepcopy(value)
        else:
            result[key] = copy.deepcopy(value)
    return result
