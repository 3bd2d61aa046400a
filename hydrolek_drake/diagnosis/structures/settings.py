"""Every constant of the search among structures, with the principle or measurement it comes from."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Rung:
    """One rung of a race: how a structure is fitted, and how many go on.

    Attributes:
        observer_s: time constant of the observer [s]; infinite for free rollouts.
        coarse: integration step over the rig's own.
        seconds: so much of the recordings is seen.
        rounds: steps of a fit.
        keep: so many fits go on.
    """

    observer_s: float
    coarse: float
    seconds: float
    rounds: int
    keep: int


@dataclass(frozen=True)
class Settings:
    """Constants of the search."""

    sizes: tuple[float, ...] = (1.0, 0.1, 0.01)
    """Sizes at which an addition is tried, as multiples of where its search begins."""

    starts: int = 2
    """So many places of each addition are fitted from on each way."""

    free: tuple[Rung, ...] = (
        Rung(math.inf, 2.0, 20.0, 4, 12),
        Rung(math.inf, 2.0, math.inf, 5, 6),
        Rung(math.inf, 1.0, math.inf, 10, 6),
    )
    """A race of free rollouts, from where the structure before it led."""

    continued: tuple[Rung, ...] = (
        Rung(0.1, 2.0, 20.0, 3, 14),
        Rung(0.5, 2.0, math.inf, 4, 8),
        Rung(3.0, 2.0, math.inf, 5, 6),
        Rung(math.inf, 1.0, math.inf, 10, 6),
    )
    """A race by continuation, from the rig's own numbers: prediction errors of an observer forget, so that they have
    few local minima (Ljung, System Identification, 1999, chapter 7); free rollouts see what is slow."""

    nominal: tuple[Rung, ...] = (
        Rung(0.1, 2.0, math.inf, 4, 4),
        Rung(1.0, 2.0, math.inf, 4, 4),
        Rung(math.inf, 1.0, math.inf, 10, 1),
    )

    most_additions: int = 3
    beam: int = 2
