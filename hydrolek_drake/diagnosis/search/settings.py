"""Every constant of the search among structures, with the principle or measurement it comes from."""

import math
from dataclasses import dataclass

LAST_STEP = 0.5
"""Last fits use this fraction of the rig's own step, so that the step's error cannot decide."""

AT_BOUND = 1e-3
"""A fitted parameter this close to an end of its range (in ranges) cannot move on."""

WIDER = 4.0
"""A range that proves too narrow is widened so many times; a law that acts near a place reaches so much farther or less
far than where its fit begins."""


SIZES = (1.0, 0.1, 0.01)
"""Sizes at which an effect is tried, as multiples of where its search begins."""

TELLING = 2.0
"""What an addition changes is told by rollouts with steps so many times the rig's own on both sides of a difference."""


@dataclass(frozen=True)
class Rung:
    """One rung of a race: how a structure is fitted, and how many go on.

    Attributes:
        observer_s: time constant of the observer [s]; infinite for free rollouts.
        coarse: integration step over the rig's own.
        seconds: so much of the recordings is seen.
        rounds: steps of a fit.
        keep: so many fits go on.
        share: fits end where a step takes less than this share of what is left.
        elsewhere: whether what has no slope is tried elsewhere.
        each: so many fits of a structure go on at most, in different minima.
    """

    observer_s: float
    coarse: float
    seconds: float
    rounds: int
    keep: int
    share: float = 5e-4
    elsewhere: bool = False
    each: int = 2


@dataclass(frozen=True)
class Settings:
    """Constants of the search."""

    starts: int = 2
    """So many places of each addition are fitted from on each way."""

    scanned: int = 4
    """The same of those without a slope."""

    parted: int = 3
    """So many structures of a race are fitted part by part at most."""

    entrants: int = 24
    """So many additions of those that promise most are fitted; there are fewer effects, and more terms of laws."""

    doubled: int = 8
    """So many of them from more than one start."""

    free: tuple[Rung, ...] = (
        Rung(math.inf, 2.0, 20.0, 5, 8),
        Rung(math.inf, 2.0, math.inf, 12, 4, elsewhere=True),
    )
    """A race of free rollouts, from where the structure before it led."""

    continued: tuple[Rung, ...] = (
        Rung(0.1, 2.0, 20.0, 4, 12),
        Rung(0.5, 2.0, math.inf, 8, 8, elsewhere=True),
        Rung(3.0, 2.0, math.inf, 12, 4, elsewhere=True),
    )
    """A race by continuation, from the rig's own numbers: prediction errors of an observer forget, so that they have
    few local minima (Ljung, System Identification, 1999, chapter 7); free rollouts see what is slow."""

    ended: tuple[Rung, ...] = (
        Rung(math.inf, 1.0, math.inf, 8, 4),
        Rung(math.inf, 1.0, math.inf, 32, 4, share=1e-4, elsewhere=True),
    )
    """The end of both races."""

    nominal: tuple[Rung, ...] = (
        Rung(0.1, 2.0, math.inf, 8, 4),
        Rung(0.5, 2.0, math.inf, 8, 4),
        Rung(3.0, 1.0, math.inf, 12, 4),
    )
    """The nominal model by continuation."""

    near: tuple[Rung, ...] = (
        Rung(0.5, 1.0, math.inf, 6, 4, each=4),
        Rung(math.inf, 1.0, math.inf, 20, 1, share=1e-4),
    )
    """Fits from places near one that ended."""

    near_spreads: tuple[float, ...] = (0.003, 0.01, 0.03)
    """Standard deviations of their distances from it in each parameter [ranges]."""

    near_each: int = 5
    """So many places at each of them: with the one in their middle two tables of lanes."""

    near_rounds: int = 6
    """So often they are looked for at most."""

    again: Rung = Rung(math.inf, 1.0, math.inf, 32, 1, share=1e-4)
    """Fits that begin where nearly the same one ended."""

    led: Rung = Rung(math.inf, 1.0, math.inf, 6, 1)
    """The same of a structure that is far from the noise, or was led by another fit: it is fitted again later."""

    last: Rung = Rung(math.inf, LAST_STEP, math.inf, 4, 8, share=1e-4)
    """The last fits, with half of the rig's own step, so that the error of the integration cannot decide."""

    nearer: float = 0.8
    """A structure that leaves this share of what the one left that the data are weighed by tells their noise better."""

    most_expansions: int = 8
    """So many structures are enlarged at most."""

    patience: int = 3
    """The search ends once so many rounds have not improved the best structure."""

    lost: float = 0.3
    """Commands that got lost are fitted if they promise this share of what is left above the noise."""

    lost_rounds: int = 5
    """So often windows of lost commands are looked for beside those that were fitted: what large ones leave hides
    small ones."""

    most_additions: int = 3
    beam: int = 2
