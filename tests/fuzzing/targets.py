"""Where each target is: only what it needs is loaded."""

import importlib

from fuzzing.target import Target

_MODULES = {
    **dict.fromkeys(("csv", "parquet"), "table_targets"),
    "tdms": "logger_targets",
    **dict.fromkeys(("mat", "mat73"), "matlab_targets"),
    **dict.fromkeys(("mcap", "db3", "bag"), "bag_targets"),
    "mdf": "logger_targets",
    **dict.fromkeys(("rig", "scenario", "design"), "yaml_targets"),
    **dict.fromkeys(("site", "base", "place"), "standing_targets"),
    **dict.fromkeys(("link", "answer"), "link_targets"),
    "console": "console_targets",
}

NAMES = tuple(_MODULES)
"""Of all targets."""

TRAP = "trap"
"""Of one that fails on purpose: tests of the runner itself."""


def target_named(name: str) -> Target:
    """A target by its name."""
    module = importlib.import_module(f"fuzzing.{_MODULES.get(name, 'trap_target')}")
    return {target.name: target for target in module.TARGETS}[name]
