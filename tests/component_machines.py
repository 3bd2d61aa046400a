"""Rig files of machines with one component each, built from a built-in rig's file."""

import functools
from pathlib import Path
from typing import Any

import yaml

from hydrolek_drake.rigs import built_in_rigs


@functools.cache
def machines() -> dict[str, Any]:
    """Component's name -> what it puts in the place of sections."""
    path = Path(__file__).parent / "data" / "components" / "machines.yaml"
    return dict(yaml.safe_load(path.read_text(encoding="utf-8")))


def sound() -> tuple[str, ...]:
    """Names of those that a rig may have."""
    return tuple(name for name, sections in machines().items() if not sections.get("refused"))


def _flows(numbers: list[float]) -> dict[str, Any]:
    """A flow map's entries: flows of an orifice at every drop, less a tenth at the highest."""
    roots = {"low": 1.0, "middle": 7.0**0.5, "high": 0.9 * 20.0**0.5}
    return {
        f"flow_{side}_{20 * (place + 1)}_{drop}": {"value": flow * root, "unit": "l/min", "source": "test"}
        for side in "ab"
        for place, flow in enumerate(numbers)
        for drop, root in roots.items()
    }


def machine_text(name: str) -> str:
    """The rig file of the machine with a component."""
    sections = {key: value for key, value in machines()[name].items() if key != "refused"}
    tree = yaml.safe_load(built_in_rigs()[sections.pop("of")].read_text(encoding="utf-8"))
    tree["name"] = name
    for section, content in sections.items():
        if section not in tree["joints"]:
            tree[section] = content
            continue
        joint = tree["joints"][section]
        for stage, given in content.items():
            entries = dict(given)
            if "flows" in entries:
                entries |= _flows(entries.pop("flows"))
            joint[stage] = entries if "variant" in entries else joint.get(stage, {}) | entries
    return str(yaml.safe_dump(tree, sort_keys=False))
