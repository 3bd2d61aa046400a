"""A rig back to the tree of a file that loads to the same rig."""

import copy
import math
from collections.abc import Mapping
from typing import Any

from hydrolek_drake.rigs.machine.short_law import LawTerm
from hydrolek_drake.rigs.parameters.declarations import declared
from hydrolek_drake.rigs.parameters.entries import Entry, written_entry


def written_tree(
    read: Mapping[str, Any],
    entries: Mapping[str, Entry],
    variants: Mapping[str, str],
    joints: tuple[str, ...],
    laws: Mapping[str, tuple[LawTerm, ...]],
) -> dict[str, Any]:
    """The rig's tree with its present values; what is neutral, or follows from the arms, is left out.

    Args:
        read: the tree that it was read from.
        entries: as of `rig.Rig`, and so are the others.
        variants: of its stages.
        joints: that move.
        laws: of them.
    """
    tree: dict[str, Any] = copy.deepcopy(dict(read))
    held = tree.pop("_held", None)
    tree.pop("effects", None)  # each joint gets its own below
    for sections in tree["joints"].values():
        sections.pop("effects", None)
        sections.pop("law", None)
    for joint, terms in laws.items():
        tree["joints"][joint]["law"] = [term.as_tree() for term in terms]
    for path, entry in entries.items():
        neutral = entry.value == declared(path, variants).neutral
        if ".effects." in path:
            left_out = neutral and entry.range is None
        else:
            left_out = neutral and entry.source.startswith("neutral:")
        if not left_out and not (entry.same_as is None and math.isnan(entry.value)):
            _write(tree, path, entry)
    if held:
        tree["joints"].update(held)
        tree["keep"] = list(joints)
    return tree


def _write(tree: dict[str, Any], path: str, entry: Entry) -> None:
    head, _, of_effect = path.partition(".effects.")
    if of_effect:
        effect_id, _, name = of_effect.rpartition(".")
        keys = [*head.split("."), "effects", effect_id, name]
    else:
        keys = path.split(".")
    node = tree
    for key in keys[:-1]:
        if not isinstance(node.get(key), dict):
            node[key] = {}  # a stage without parameters may stand in the file as nothing
        node = node[key]
    node[keys[-1]] = written_entry(entry)
