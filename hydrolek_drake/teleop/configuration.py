"""The numbers of `teleop.yaml`, in SI units except where their name says otherwise."""

from functools import cache
from importlib.resources import files
from types import MappingProxyType

import yaml


@cache
def teleop_entries(part: str) -> MappingProxyType[str, float]:
    """Name -> value of one part, such as `task` or `link`."""
    data = yaml.safe_load(files(__package__).joinpath("teleop.yaml").read_text(encoding="utf-8"))
    return MappingProxyType({name: float(entry["value"]) for name, entry in data[part].items()})
