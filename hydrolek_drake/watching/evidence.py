"""Evidence that adds up over recordings, with bounded false alarms however long a series becomes.

Of each recording the likelihood ratio between some size of an effect and none is known. Where nothing changed its mean
is one, and so is that of any mixture over sizes that follow one another as states of a Markov chain: it begins with any
recording, the n-th one with the probability 1 / (n (n + 1)), at any of some sizes alike, and then stays nearly there or
grows. Such a mixture exceeds 1 / p with the probability p at most (Ville 1939; Shiryaev, Theory of Probability and its
Applications 8, 1963, 22; Shin, Ramdas, Rinaldo, E-detectors, New England Journal of Statistics in Data Science 2023). A
recording that tells nothing has the ratio one for all sizes and changes nothing. One alone counts no more than an alarm
asks for, and the probability of a mishap, whose ratio is one, bounds what it says against an effect: both leave the
mean at one or below (bounded influence; Huber, Annals of Mathematical Statistics 36, 1965, 1753).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ndtr
from scipy.stats import chi2

from hydrolek_drake.watching.common_error import ALONE, prior_of_shared
from hydrolek_drake.watching.fitting.likelihood import Profile
from hydrolek_drake.watching.settings import BEYOND, FALLS, GROWS, MISHAP, OCTAVES, STAYS

MOST = 1e200
"""Evidence above this is not told apart: so near the largest number that there is."""


@dataclass(frozen=True)
class Sizes:
    """Cells of sizes of one effect, each twice as large as the one before, the last one wider.

    Attributes:
        edges: strengths between them, growing, above zero. # (m + 1,)
        signs: 1 alone for an effect of one sign, or 1 and -1.
    """

    edges: np.ndarray
    signs: tuple[float, ...] = (1.0,)

    @property
    def count(self) -> int:
        """How many cells there are."""
        return (self.edges.size - 1) * len(self.signs)

    def ratios(self, profile: Profile, tempered: float, shared: np.ndarray = ALONE) -> np.ndarray:
        """Logarithms of the mean likelihood ratios of each cell, against none, beside each error of the reference.

        The root of the rise is straight between the sizes of a profile, so that its integral is a normal one.

        Args:
            profile: of the effect's size, in squares.
            tempered: squares that count as one.
            shared: strengths that the reference's error makes, against which cells are held. # (k,)

        Returns:
            One row an error. # (k, count)
        """
        ends = np.concatenate([np.sort(sign * self.edges)[None] + shared[:, None] for sign in self.signs])
        at = np.unique(np.concatenate([ends.ravel(), np.array(profile.sizes)]))
        roots = profile.roots(at) / np.sqrt(tempered)
        rising = np.diff(roots)
        flat = np.abs(rising) < 1e-9
        area = np.sqrt(2.0 * np.pi) * np.diff(ndtr(roots)) / np.where(flat, 1.0, rising)
        area = np.diff(at) * np.where(flat, np.exp(-0.5 * roots[:-1] ** 2), area)
        places = np.searchsorted(at, ends)
        whole = np.add.reduceat(np.append(area, 0.0), places.ravel()).reshape(places.shape)[:, :-1]
        told = np.log(np.maximum(whole / np.diff(ends, axis=1), 1e-300)).reshape(
            len(self.signs), len(shared), -1
        )
        rows = [part if sign > 0.0 else part[:, ::-1] for part, sign in zip(told, self.signs, strict=True)]
        none = profile.roots(shared) / np.sqrt(tempered)
        return np.asarray(np.concatenate(rows, axis=1) + 0.5 * none[:, None] ** 2)


def sizes_by(deviation: float, both: bool) -> Sizes:
    """Cells from half of what a healthy recording leaves uncertain.

    Args:
        deviation: standard deviation of the effect's strength in a recording of the reference.
        both: whether it has two signs.
    """
    octaves = np.arange(-1.0, OCTAVES)
    octaves[-1] += BEYOND
    return Sizes(deviation * 2.0**octaves, (1.0, -1.0) if both else (1.0,))


def by_chance(probability: float) -> float:
    """Logarithm of a ratio whose mean is one at most, by how probable as much is by chance.

    Vovk, Wang, Annals of Statistics 49, 2021, 1736: the mean over k of k p^(k - 1).
    """
    p = min(max(probability, 1e-300), 1.0)
    less = np.log(p)
    if less > -1e-3:
        return float(np.log(0.5))
    return float(np.log((1.0 - p + p * less) / (p * less * less)))


def as_one_number(gain: float, parameters: int) -> float:
    """The gain of one number that is as improbable by chance as this one of several."""
    if parameters <= 1 or gain <= 0.0:
        return max(gain, 0.0)
    return float(chi2.isf(max(chi2.sf(gain, parameters), 1e-290), 1)) if gain < 1000.0 else gain


def bounded(ratios: np.ndarray, most: float) -> np.ndarray:
    """Ratios of one recording with bounded influence: no more than some, and one where it is a mishap.

    Args:
        ratios: logarithms, of any shape.
        most: of the largest, too.
    """
    return np.asarray(MISHAP + (1.0 - MISHAP) * np.exp(np.minimum(ratios, most)))


class Evidence:
    """The mixture for one effect, recording after recording, beside each error that the reference may have.

    Attributes:
        total: of the mixture, in the mean over these errors.
        since: number of the recording with which the likeliest course of sizes begins, whichever that is (a cumulative
            sum; Page, Biometrika 41, 1954, 100).
    """

    def __init__(self) -> None:
        """Begin with none."""
        self.total, self.since = 0.0, 0
        self._none = np.zeros(0)
        self._parts, self._best = np.zeros((0, 0)), np.zeros((0, 0))
        self._begun = np.zeros((0, 0), dtype=int)

    def add(self, ratios: np.ndarray, number: int, none: np.ndarray | None = None) -> None:
        """Take what a recording says.

        Args:
            ratios: of each cell of sizes, bounded, beside each error of the reference. # (k, m)
            number: of the recording, from 1.
            none: logarithms of how likely the recording is by each error alone; None for all alike. # (k,)
        """
        errors, count = ratios.shape
        if self._parts.shape != ratios.shape:
            self._parts, self._best = np.zeros(ratios.shape), np.zeros(ratios.shape)
            self._begun, self._none = np.zeros(ratios.shape, dtype=int), prior_of_shared(errors)
        if none is not None:
            self._none = self._none + none
        ways = _followers(count)
        begins = 1.0 / (number * (number + 1) * count)
        self._parts = np.minimum(ratios * (self._parts @ ways + begins), MOST)
        weights = np.exp(self._none - self._none.max())
        self.total = float(weights @ self._parts.sum(axis=1) / weights.sum())
        courses = self._best[:, :, None] * ways
        from_one = courses.max(axis=1)
        before = np.take_along_axis(self._begun, courses.argmax(axis=1), axis=1)
        self._begun = np.where(from_one > 1.0 / count, before, number)
        self._best = np.minimum(ratios * np.maximum(from_one, 1.0 / count), MOST)
        error, cell = np.unravel_index(int(np.argmax(weights[:, None] * self._best)), ratios.shape)
        self.since = int(self._begun[error, cell])


@lru_cache
def _followers(count: int) -> np.ndarray:
    """Probabilities of one cell of sizes after another; of those with the other sign none. # (count, count)."""
    if count == 1:
        return np.ones((1, 1))
    cells = OCTAVES
    one = STAYS * np.eye(cells) + FALLS * np.eye(cells, k=-1) + GROWS * np.eye(cells, k=1)
    one[-1, -1] += GROWS
    one[0, 0] += FALLS
    return np.kron(np.eye(count // cells), one)
