"""Which variable of a unit is which signal of a recording."""

import difflib
from collections.abc import Mapping
from typing import NamedTuple

from hydrolek_drake.errors import InputError
from hydrolek_drake.fmu.foreign import Shown, Unit
from hydrolek_drake.recordings.apart.found import names_with_unit
from hydrolek_drake.recordings.columns import IGNORE, TIME, check_mapping, parse_column

_MANY = 12


class Wire(NamedTuple):
    """A variable that is a signal.

    Attributes:
        variable: name in the unit.
        key: of the signal, `<joint>.<quantity>`.
        factor: SI value = factor times the variable's.
        unit: the SI unit.
    """

    variable: str
    key: str
    factor: float
    unit: str


def wired(
    unit: Unit, mapping: Mapping[str, str], elsewhere: Mapping[str, str]
) -> tuple[list[Wire], list[Wire]]:
    """Inputs and outputs of a unit that are signals.

    Args:
        unit: it.
        mapping: variable -> name of the contract with unit, such as boom.angle_deg; the unit must have these.
        elsewhere: likewise, of a rig, whose other names are passed over.

    Raises:
        InputError: a variable is not there or no number, a name cannot be understood, or two variables are one signal.
    """
    check_mapping(mapping)
    for name in mapping:
        if name not in unit.variables:
            near = difflib.get_close_matches(name, unit.variables, n=3, cutoff=0.4)
            raise InputError(f"{unit.path} has no variable '{name}'; nearest: {', '.join(near) or 'none'}")
        if not unit.variables[name].number:
            raise InputError(f"{unit.path}: '{name}' is no single real number, which a signal is")
    chosen = {**{k: v for k, v in elsewhere.items() if k in unit.variables}, **mapping}
    found = [
        wire for each in unit.variables.values() if (wire := _wire(each, chosen.get(each.name))) is not None
    ]
    mapped = {wire.key for wire in found if wire.variable in chosen}
    found = [wire for wire in found if wire.variable in chosen or wire.key not in mapped]
    taken: dict[str, str] = {}
    for wire in found:
        if wire.key in taken:
            raise InputError(
                f"{unit.path}: '{taken[wire.key]}' and '{wire.variable}' would both be {wire.key}; map one to {IGNORE}"
            )
        taken[wire.key] = wire.variable
    inputs = [wire for wire in found if unit.variables[wire.variable].causality == "input"]
    outputs = [wire for wire in found if unit.variables[wire.variable].causality in ("output", "local")]
    return inputs, outputs


def listed(unit: Unit, causality: str) -> str:
    """Names of a unit's numbers of one causality, for messages."""
    names = [each.name for each in unit.variables.values() if each.number and each.causality == causality]
    more = f" and {len(names) - _MANY} more" if len(names) > _MANY else ""
    return (", ".join(names[:_MANY]) + more) or "none"


def _wire(variable: Shown, target: str | None) -> Wire | None:
    if not variable.number or target == IGNORE:
        return None
    stated = variable.unit.replace("N.m", "N m")
    named = names_with_unit((variable.name,), stated)[::-1] if target is None else (target,)
    for name in named:
        try:
            understood = parse_column(name)
        except InputError:
            if target is not None:
                raise
            continue
        if understood is not None and understood.key != TIME:
            return Wire(variable.name, understood.key, understood.factor, understood.unit)
    return None
