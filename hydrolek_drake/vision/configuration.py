"""The entries of `kinect.yaml`: value, unit and source of every number that the camera and the vision use."""

from functools import cache
from types import MappingProxyType
from typing import Any

from hydrolek_drake.units import si_factor
from hydrolek_drake.yaml_files import package_yaml

_SI = {"deg": "rad", "mm": "m"}


@cache
def kinect_entries(part: str) -> MappingProxyType[str, float]:
    """Name -> value in SI units of one part of `kinect.yaml`, such as `camera` or `edges`."""
    data: dict[str, dict[str, dict[str, Any]]] = package_yaml(__package__, "kinect.yaml")
    values = {}
    for name, entry in data[part].items():
        unit = entry["unit"]
        values[name] = float(entry["value"]) * (si_factor(unit, _SI[unit]) if unit in _SI else 1.0)
    return MappingProxyType(values)
