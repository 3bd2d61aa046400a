"""How physics in no list is looked for: unknown inputs, laws read from them, and commands that got lost."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Locating:
    """Unknown inputs at each stage, and laws read from them."""

    knots_s: float = 0.05
    """Between knots [s]: a joint hardly follows what is faster."""

    observer_s: float = 0.3
    """Time constant of the observer whose innovations tell of unknown inputs [s]: longer than a valve takes to open,
    and far shorter than a move."""

    forgotten: float = 6.0
    """So many time constants after an input its trace in the innovations is gone (e^-6)."""

    coarse: float = 2.0
    """Steps so many times the rig's own tell innovations: with four times as long ones those of a machine that lacks
    nothing have 1.4 times the squares of its noise (bench)."""

    amplitude: float = 1e-3
    """Of a trial, in scales of the input: small enough to be linear."""

    fitted: int = 3
    """Steps by which a structure's own parameters are fitted to innovations before they are asked for unknown
    inputs."""

    each: int = 3
    """So many terms of each input are offered, and the best of all beyond these."""

    offered: int = 20
    """So many terms are offered in all, about as many as there are effects."""

    highest_hz: float = 8.0
    """Frequencies up to this one are looked for; joints hardly follow faster ones."""

    lowest: float = 3.0
    """Cycles at least within a recording; what is slower is no vibration."""

    peaks: int = 2
    """So many frequencies of each input are followed."""

    breadth_hz: float = 0.06
    """Half of the range in which the frequency of a periodic term is fitted about where it was seen."""

    scan_s: float = 12.0
    """Frequencies are told in cycles in so many seconds where their intervals are worked out."""

    sizes: tuple[float, ...] = (0.3, 0.1, 0.03, 0.003)
    """Amplitudes at which a term is tried, in scales of its input."""


LOCATING = Locating()


@dataclass(frozen=True)
class Dropouts:
    """Commands that got lost: windows in which the machine has none."""

    sample_s: float = 0.02
    """About one sample of a controller [s]: between knots at which commands may be lost, and windows that lie no
    farther apart are one."""

    longest_s: float = 0.5
    """A command that is lost for longer is a recording of two pieces."""

    moves_s: float = 0.3
    """A move hardly changes within so much: windows are tried up to so long, and fitted within so much to either side
    of where they were seen."""

    shortest_s: float = 1e-3
    """Shorter windows are no time that a rollout resolves."""

    most_share: float = 0.1
    """So much of a recording may be lost at most: a line that loses more is not in use."""

    whole: float = 1.2
    """Multiple of a command that may be missing: there is no more in it to be lost but for the observer's own error."""

    remembers_s: float = 3.0
    """Time constant of the observer [s]. A joint that misses its command for a few milliseconds is off by little, and
    for good: a faster observer forgets it before it can be told from noise."""

    @property
    def most_knots(self) -> int:
        """A window is tried over so many spacings of knots at most."""
        return round(self.moves_s / self.sample_s)


DROPOUTS = Dropouts()
