"""What a reader that runs in a process of its own is asked for, and what it gives."""

from dataclasses import dataclass, field

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.columns import parse_column


@dataclass(frozen=True)
class Found:
    """A column of a file.

    Attributes:
        names: Names that it answers to, the fullest first.
        values: Numbers or text; None where nobody asked for it. # (n,)
        group: Whose time it is sampled at; see `Table`.
    """

    names: tuple[str, ...]
    values: np.ndarray | None
    group: str = ""


@dataclass(frozen=True)
class Asked:
    """What the caller wants to know of a file.

    Attributes:
        mapped: Names that the rig maps.
        options: Further settings of the reader.
    """

    mapped: frozenset[str] = frozenset()
    options: dict[str, object] = field(default_factory=dict)

    def wants(self, names: tuple[str, ...]) -> bool:
        """Whether a column of these names is mapped, or one of them is a name of the contract."""
        return any(name in self.mapped or _understood(name) for name in names)


def _understood(name: str) -> bool:
    try:
        return parse_column(name) is not None
    except InputError:
        return True  # what is wrong with it is said where columns are resolved


def names_with_unit(names: tuple[str, ...], unit: str) -> tuple[str, ...]:
    """The names of a column whose unit the file states: also each with that unit, `j.angle` in deg as `j.angle_deg`."""
    unit = unit.strip().replace("/", "_per_").replace("%", "percent")
    if not unit or len(unit) > 20 or not unit.isprintable() or " " in unit:
        return names
    return (*names, *(f"{name}_{unit}" for name in names))
