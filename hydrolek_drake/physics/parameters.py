"""How a stage or an effect declares its parameters: name, unit and meaning stand beside the equation.

From these declarations follow the record that the compiled physics reads, the keys and units that a rig
file must use, and the tables of the documentation.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Parameter:
    """One physical parameter.

    Attributes:
        name: key in the rig file and field of the record.
        unit: SI unit ("1" for none).
        meaning: what it is, in one line.
        neutral: value that switches the physics behind it off; None if a rig must state it.
        lowest: smallest admissible value (physics, not taste).
        highest: largest admissible value.
        positive: zero and below are not admissible, since something is divided by it.
        arrival: it says when commands arrive, at which steps of the integration end.
    """

    name: str
    unit: str
    meaning: str
    neutral: float | None = None
    lowest: float = -np.inf
    highest: float = np.inf
    positive: bool = False
    arrival: bool = False


@dataclass(frozen=True)
class Stage:
    """The parameters of one stage and of its variants.

    Attributes:
        name: the section in the rig file.
        meaning: what the stage does.
        common: parameters of every variant.
        variants: name -> further parameters; the record stores the variant as its position in this mapping.
        default: the variant of a rig that names none; empty where a rig must, unless the first one needs nothing of its
            own.
    """

    name: str
    meaning: str
    common: tuple[Parameter, ...]
    variants: dict[str, tuple[Parameter, ...]]
    default: str = ""

    def parameters(self, variant: str) -> tuple[Parameter, ...]:
        """All parameters of one variant."""
        return self.common + self.variants[variant]

    def code(self, variant: str) -> int:
        """The number by which the compiled physics knows the variant."""
        return list(self.variants).index(variant)

    def dtype(self) -> np.dtype:
        """The stage's record: the variant's code and every parameter of any variant, in declared order."""
        names: dict[str, None] = dict.fromkeys(p.name for p in self.common)
        for parameters in self.variants.values():
            names.update(dict.fromkeys(p.name for p in parameters))
        return np.dtype([("variant", np.float64)] + [(name, np.float64) for name in names])
