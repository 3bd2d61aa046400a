"""How structures are fitted and searched."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Fits:
    """How a structure is fitted."""

    horizons: tuple[tuple[float, float], ...] = (
        (0.03, 10.0),
        (0.1, 10.0),
        (0.3, 20.0),
        (1.0, 20.0),
        (math.inf, 20.0),
        (1.0, math.inf),
    )
    """Continuation: time constants of the observer [s], each three times the one before, and how much of the
    recordings each is shown [s]. What an observer forgets makes few local minima, what it remembers tells slow things;
    the fastest remembers some samples of a recording, and one swing of a joint against its oil, and sees three hundred
    of these in 10 s. What the rest of a recording asks for is asked by an observer first: free rollouts that had
    explained 20 s of a boom with air in its oil ended at 1.6 times the noise of all."""

    coarse: float = 4.0
    """Steps so many times the rig's own lead fits until their end, and tell what an addition changes where they are on
    both sides of a difference."""

    runs_away: float = 10.0
    """A rollout in longer steps has run away if it leaves so many times what one in the rig's own leaves: they leave
    nearly the same, or thousands of times as much."""

    last_step: float = 0.5
    """Last fits use this fraction of the rig's own step, so that the step's error cannot decide."""

    shorter: float = 8.0
    """The error that the step of the last fits leaves is told by one so many times shorter: for a method of second
    order all but a sixty-fourth of it."""

    tolerance: float = 1e-3
    """Differences by less than this share are none: a number so near an end of its range (in ranges) cannot move on,
    and two fits of a structure whose squares are so nearly the same stand in the same minimum."""

    behind: float = 0.01
    """Who is behind the best of a race need not be known better than to this share of the distance."""

    negligible: float = 1e-6
    """A share that changes nothing which a rollout shows: fits begin so far within their ranges, from where steps to
    both sides can be made, and so much of an effect does nothing."""

    wider: float = 4.0
    """A range that proves too narrow is widened so many times; a law that acts near a place reaches so much farther
    or less far than where its fit begins."""

    sizes: tuple[float, ...] = (1.0, 0.1, 0.01)
    """Sizes at which an effect is tried, as multiples of where its search begins."""

    wide: tuple[float, ...] = (0.03, 0.01, 0.001)
    """Differences [ranges] by which the slopes of a play, and of a joint that sticks and slips, are told at first: over
    a millionth they are those of single contacts and breakaways. Fits of a play to innovations ended at 6 times the
    noise with these alone, at 3 with such wide ones, and at 5.4 and 2.1 (590/012, 570/013; T = 0.1 s); those of a
    Stribeck friction at 1.9, 1.8 and 1.4, 1.2 (hopsan_link, h05; T = 0.03 s, two starts)."""

    strides: tuple[float, ...] = (0.25, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 1.02, 1.05, 1.1, 1.25, 1.5, 2.0, 4.0)
    """Multiples of a size without a slope at which it is tried elsewhere: closer together the nearer they are."""

    places: int = 16
    """So many places without a slope are tried side by side: two tables of lanes."""

    closer: int = 2
    """So often what has no slope is searched closer about the best of these places, each time eight times as close: a
    recording of 40 s to 0.04 s, within which no joint moves far."""

    anew: int = 3
    """So often is a fit begun anew at most: with data weighed by a better one, or in a lower local minimum."""


FITS = Fits()


@dataclass(frozen=True)
class Rung:
    """One rung of a race: how a structure is fitted, and how many go on.

    Attributes:
        observer_s: time constant of the observer [s]; infinite for free rollouts.
        coarse: integration step over the rig's own.
        seconds: so much of the recordings is seen.
        rounds: steps of a fit.
        keep: so many fits go on.
        share: fits end where a step takes less than this share of what is left, an eighth of what one more addition
            must bring (`Gains`): what takes less decides nothing; ...
        behind: or of how far they are behind the best of them, or behind the noise.
        elsewhere: whether what has no slope is tried elsewhere.
        each: so many fits of a structure go on at most, in different minima.
    """

    observer_s: float
    coarse: float
    seconds: float
    rounds: int
    keep: int
    share: float = 5e-4
    behind: float = 0.0
    elsewhere: bool = False
    each: int = 2


def _continued(
    rounds: tuple[int, ...], keep: tuple[int, ...], share: float, behind: float, each: int
) -> tuple[Rung, ...]:
    """Rungs of a continuation. The first one leads with long steps; the error of these is none of what is compared."""
    return tuple(
        Rung(t, 1.0 if i else FITS.coarse, seconds, steps, left, share, behind, i > 0, each)
        for i, ((t, seconds), steps, left) in enumerate(zip(FITS.horizons, rounds, keep, strict=True))
    )


@dataclass(frozen=True)
class Settings:
    """The search among structures, which may be asked for with other numbers."""

    starts: int = 2
    """So many places of each addition are fitted from on each way."""

    scanned: int = 4
    """The same of those without a slope."""

    supplied: int = 3
    """So many structures of a race have their supply found anew at most."""

    entrants: int = 24
    """So many additions of those that promise most are fitted; there are fewer effects, and more terms of laws."""

    doubled: int = 8
    """So many of them from more than one start."""

    free: tuple[Rung, ...] = (
        Rung(math.inf, FITS.coarse, 20.0, 5, 8, behind=FITS.behind),
        Rung(math.inf, FITS.coarse, math.inf, 12, 4, behind=FITS.behind, elsewhere=True),
    )
    """A race of free rollouts, from where the structure before it led."""

    continued: tuple[Rung, ...] = _continued(
        (6, 8, 12, 12, 12, 12), (16, 8, 6, 4, 4, 4), 5e-4, FITS.behind, 2
    )
    """A race by continuation, from the rig's own numbers: prediction errors of an observer forget, so that they have
    few local minima (Ljung, System Identification, 1999, chapter 7); free rollouts see what is slow."""

    ended: tuple[Rung, ...] = (
        Rung(math.inf, 1.0, math.inf, 8, 4, behind=FITS.behind),
        Rung(math.inf, 1.0, math.inf, 32, 4, behind=FITS.behind, elsewhere=True),
    )
    """The end of both races."""

    long: tuple[Rung, ...] = (
        *_continued((12, 40, 40, 40, 40, 40), (6, 4, 4, 4, 4, 4), 3e-4, 0.0, 3),
        Rung(math.inf, 1.0, math.inf, 60, 4, elsewhere=True),
    )
    """Continuation of the nominal model, and of the best structures of a race, where these leave more than noise, with
    as many steps as they take, from several starts. A Stribeck friction whose joint sticks and slips ended at 9.7 times
    the noise after the steps of a race, and at 0.90 with these from one of three starts (570/026); hopsan_link's h05,
    which chatters at 30 Hz, at 1.8 to 1.9 without an observer of 0.03 s, at 1.5 over all data with each six times as
    slow as the one before, and at 0.98 so."""

    to_the_end: int = 2
    """So many structures of a race are continued so."""

    drawn: int = 6
    """So many starts of the nominal model are drawn from the prior, beside the rig's own numbers and the middle of
    their ranges: with these they fill a table of lanes."""

    seed: int = 1
    """Of what is drawn: the same each time."""

    near: tuple[Rung, ...] = (
        Rung(0.5, 1.0, math.inf, 6, 4, each=4),
        Rung(math.inf, 1.0, math.inf, 20, 1),
    )
    """Fits from places near one that ended."""

    near_spreads: tuple[float, ...] = (0.003, 0.01, 0.03)
    """Standard deviations of their distances from it in each parameter [ranges]."""

    near_rounds: int = 6
    """So often they are looked for at most."""

    again: Rung = Rung(math.inf, 1.0, math.inf, 32, 1, behind=FITS.behind)
    """Fits that begin where nearly the same one ended."""

    again_within: float = 2.0
    """Structures that leave at most so many times what the best one leaves are fitted again once the data are weighed
    anew ..."""

    in_place: int = 4
    """So many effects are fitted in place of a law."""

    most_again: int = 6
    """... but no more of them: others lie behind for good."""

    led: Rung = Rung(math.inf, 1.0, math.inf, 6, 1)
    """The same of a structure that is far from the noise, or was led by another fit: it is fitted again later."""

    last: Rung = Rung(math.inf, FITS.last_step, math.inf, 4, 8, share=1e-4)
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
    """So many additions a structure has at most."""

    beam: int = 2
    """So many structures with the same number of additions are enlarged."""

    @property
    def near_each(self) -> int:
        """So many places near a fit at each distance: with the one in their middle two tables of lanes."""
        return (FITS.places - 1) // len(self.near_spreads)
