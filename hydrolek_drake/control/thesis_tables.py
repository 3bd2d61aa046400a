"""Results that the thesis prints for its SDP models, from `thesis_tables.yaml`."""

from typing import Any

from hydrolek_drake.yaml_files import package_yaml

JOINTS = ("j1", "j2", "j3", "j4")
_RAW = package_yaml(__package__, "thesis_tables.yaml")


def _by_joint(sequence: str) -> dict[str, dict[str, Any]]:
    return {
        controller: {
            key: dict(zip(JOINTS, value, strict=True)) if isinstance(value, list) else float(value)
            for key, value in rows.items()
        }
        for controller, rows in _RAW[sequence].items()
    }


STEP_TABLES = _by_joint("step")
"""Controller -> measure -> joint -> value: Tables G.3, G.4, 6.9 and 6.10."""

SINE_TABLES = _by_joint("sine")
"""The same for Tables G.1, G.2 and 6.11."""
