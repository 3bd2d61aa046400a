"""The numbers of `teleop.yaml`, in SI units except where their name says otherwise."""

from functools import cache
from types import MappingProxyType

from hydrolek_drake.yaml_files import package_yaml


@cache
def teleop_entries(part: str) -> MappingProxyType[str, float]:
    """Name -> value of one part, such as `task` or `link`."""
    data = package_yaml(__package__, "teleop.yaml")
    return MappingProxyType({name: float(entry["value"]) for name, entry in data[part].items()})
