"""The thesis's controller settings, from `thesis_gains.yaml`."""

from functools import cache
from typing import Any

from hydrolek_drake.control.design import PipGains
from hydrolek_drake.control.laws.scaled_input import ScaledInput
from hydrolek_drake.errors import InputError
from hydrolek_drake.yaml_files import package_yaml


@cache
def gains_data() -> dict[str, Any]:
    """Content of the file."""
    return package_yaml(__package__, "thesis_gains.yaml")


def entry(table: str, joint: str) -> dict[str, Any]:
    """One joint's entry of "pip_no_scaling", "pip_scaled", "pip_idz.a", "pip_forward.c", ...

    Raises:
        InputError: no such table or joint.
    """
    node: Any = gains_data()
    for key in (*table.split("."), joint):
        if key not in node:
            raise InputError(f"the thesis has no '{key}' in {table} of {joint}; choose {', '.join(node)}")
        node = node[key]
    return node


def pip_gains(table: str, joint: str) -> PipGains:
    """Gains of Table 6.5 or 6.6 as printed."""
    found = entry(table, joint)
    return PipGains(tuple(found["f"]), tuple(found["g"]), float(found["k_i"]))


def scaled_input(joint: str) -> ScaledInput:
    """Scaling of Table 6.3."""
    dead_n, dead_p, lowest, highest, factor_n, factor_p = map(float, entry("scaling", joint))
    return ScaledInput(dead_n, dead_p, lowest, highest, factor_n, factor_p, signal_limit())


def sample_s() -> float:
    """Control sample time [s]."""
    return float(gains_data()["control"]["sample"]["value"])


def voltage_limit_V() -> float:
    """Largest voltage of the field point [V]."""
    return float(gains_data()["control"]["voltage_limit"]["value"])


def signal_limit() -> float:
    """Largest signal [percent]."""
    return float(gains_data()["control"]["signal_limit"]["value"])
