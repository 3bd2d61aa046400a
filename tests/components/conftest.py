"""Machines with one component each, built from a built-in rig's file."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from hydrolek_drake.rigs import built_in_rigs, load_rig

MACHINES = yaml.safe_load((Path(__file__).parent / "machines.yaml").read_text())


def _flows(numbers: list[float]) -> dict:
    """The map's entries: flows of an orifice at every drop, less a tenth at the highest."""
    roots = {"low": 1.0, "middle": 7.0**0.5, "high": 0.9 * 20.0**0.5}
    return {
        f"flow_{side}_{20 * (place + 1)}_{drop}": {"value": flow * root, "unit": "l/min", "source": "test"}
        for side in "ab"
        for place, flow in enumerate(numbers)
        for drop, root in roots.items()
    }


@pytest.fixture(scope="session")
def with_component(tmp_path_factory):
    """A function: component's name -> the rig that has it."""
    folder = tmp_path_factory.mktemp("machines")

    def make(name: str):
        sections = dict(MACHINES[name])
        of = sections.pop("of")
        tree = yaml.safe_load((built_in_rigs()[of]).read_text())
        tree["name"] = name
        for section, content in sections.items():
            if section in tree["joints"]:
                content = {stage: dict(entries) for stage, entries in content.items()}
                if "flows" in content.get("valve", {}):
                    content["valve"] |= _flows(content["valve"].pop("flows"))
                for stage, entries in content.items():
                    joint = tree["joints"][section]
                    joint[stage] = entries if "variant" in entries else joint[stage] | entries
            else:
                tree[section] = content
        path = folder / f"{name}.yaml"
        path.write_text(yaml.safe_dump(tree))
        return load_rig(path)

    return make


@pytest.fixture
def random_volts():
    """A function: seconds -> times and voltages that jump within +-6 V."""

    def make(seconds: float, seed: int = 4):
        times = np.arange(0.0, seconds, 0.01)
        levels = np.random.default_rng(seed).uniform(-6.0, 6.0, times.size // 30 + 1)
        return times, np.repeat(levels, 30)[: times.size]

    return make
