"""Sizes that effects must not reach, as the user sets them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.effects.effect import Effect
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.parameters.declarations import at_joint
from hydrolek_drake.units import si_factor


@dataclass(frozen=True)
class Limit:
    """A size that an effect must not reach.

    Attributes:
        effect: its id.
        size: in SI.
    """

    effect: str
    size: float


def limits_of(pairs: Sequence[str], rig: Rig) -> list[Limit]:
    """Limits from `EFFECT=SIZE` each, the size in SI or with a unit: one that an effect has at a joint of the rig.

    Args:
        pairs: as written.
        rig: the machine.

    Raises:
        InputError: no such effect, or no size.
    """
    found = []
    for pair in pairs:
        name, equals, text = (part.strip() for part in pair.partition("="))
        if not (equals and name and text):
            raise InputError(f"--limit {pair}: write EFFECT=SIZE, such as cylinder.cross_port_leakage=2e-12")
        if name not in EFFECTS:
            raise InputError(f"--limit {pair}: no effect {name!r}; see hydrolek effects")
        units = _units_of(EFFECTS[name], rig)
        number, _, given = text.partition(" ")
        try:
            size = float(number) * (_factor(given.strip(), units) if given.strip() else 1.0)
        except ValueError as error:
            said = str(error) if isinstance(error, InputError) else f"{number!r} is no number"
            raise InputError(
                f"--limit {pair}: {said}; the size is in {units[0]}, or write its unit behind it"
            ) from None
        if not math.isfinite(size):
            raise InputError(f"--limit {pair}: the size must be finite")
        found.append(Limit(name, size))
    return found


def _units_of(effect: Effect, rig: Rig) -> list[str]:
    """Units of an effect's size at the joints of a rig, then those that it declares; SI."""
    size = next(p for p in effect.parameters if p.name == effect.size)
    there = [at_joint(size, effect, f"joints.{joint}", rig.variants).unit for joint in rig.joints]
    return list(dict.fromkeys(unit for units in (*there, size.unit) for unit in units.split("|")))


def _factor(given: str, units: Sequence[str]) -> float:
    """What a size stated in a unit is multiplied by.

    Raises:
        InputError: the unit is of none of these; as it is told for the first.
    """
    problems = []
    for unit in units:
        try:
            return si_factor(given, unit)
        except InputError as error:
            problems.append(error)
    raise problems[0]
