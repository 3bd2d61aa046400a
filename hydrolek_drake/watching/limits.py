"""Sizes that effects must not reach, as the user sets them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.errors import InputError
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


def limits_of(pairs: Sequence[str]) -> list[Limit]:
    """Limits from `EFFECT=SIZE` each, the size in SI or with a unit.

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
        effect = EFFECTS[name]
        unit = next(p.unit for p in effect.parameters if p.name == effect.size).partition("|")[0]
        number, _, given = text.partition(" ")
        try:
            size = float(number) * (si_factor(given.strip(), unit) if given.strip() else 1.0)
        except ValueError as error:
            said = str(error) if isinstance(error, InputError) else f"{number!r} is no number"
            raise InputError(
                f"--limit {pair}: {said}; the size is in {unit}, or write its unit behind it"
            ) from None
        if not math.isfinite(size):
            raise InputError(f"--limit {pair}: the size must be finite")
        found.append(Limit(name, size))
    return found
