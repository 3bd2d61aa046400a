"""Rigs made of parts: stages whose content stands in files of their own, and one source for all of a file's numbers."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import is_file
from hydrolek_drake.physics.records import JOINT_STAGES, SHARED_STAGES
from hydrolek_drake.yaml_files import read_yaml

USES = "uses"
"""Key of a stage: the file of a part, beside the file that names it."""

_MOST_PARTS = 16  # that use each other

Merge = Callable[[dict[str, Any], dict[str, Any]], dict[str, Any]]


def with_parts(tree: dict[str, Any], path: Path, merge: Merge) -> dict[str, Any]:
    """A rig's tree with the parts that its stages use beneath what they state themselves, and with sources.

    A part is a file with what stands under a stage: `variant`, parameters, and `source`, which holds for all of its
    numbers that state none. A rig's own `source` does the same for those of the rig.

    Args:
        tree: as read from `path`.
        path: of the rig.
        merge: writes one tree on top of another.

    Raises:
        InputError: a part that is not there, is none, or uses itself.
    """
    found = dict(tree)
    for name in SHARED_STAGES:
        if name in tree:
            found[name] = _stage(tree[name], path, name, merge, ())
    joints = tree.get("joints")
    if isinstance(joints, dict):
        found["joints"] = {
            joint: {
                name: _stage(section, path, f"joints.{joint}.{name}", merge, ())
                if name in JOINT_STAGES
                else section
                for name, section in sections.items()
            }
            if isinstance(sections, dict)
            else sections
            for joint, sections in joints.items()
        }
    return _sourced(found, tree.get("source"))


def _stage(section: Any, path: Path, where: str, merge: Merge, seen: tuple[Path, ...]) -> Any:
    if not isinstance(section, Mapping) or USES not in section:
        return section
    own = {key: value for key, value in section.items() if key != USES}
    named = section[USES]
    part = path.parent / f"{named}"
    if not isinstance(named, str) or not is_file(part):
        raise InputError(f"{path}: {where}.{USES}: no file '{named}' beside it")
    if part.resolve() in seen or len(seen) >= _MOST_PARTS:
        raise InputError(
            f"{path}: {where}.{USES}: '{named}' goes in a circle, or more than {_MOST_PARTS} parts deep"
        )
    content = read_yaml(part, "part")
    if not isinstance(content, dict):
        raise InputError(f"part {part} is empty or not a mapping; it has what stands under {where}")
    source = content.pop("source", None)
    content = _stage(content, part, where, merge, (*seen, part.resolve()))
    return merge(_sourced(content, source), own)


def _sourced(tree: Any, source: Any) -> Any:
    """The tree with a source for every number that states none."""
    if not isinstance(source, str) or not isinstance(tree, dict):
        return tree
    found = {key: _sourced(value, source) for key, value in tree.items()}
    if "value" in found and "unit" in found and "source" not in found:
        found["source"] = source
    return found
