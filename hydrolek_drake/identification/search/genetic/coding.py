"""Chromosomes: a place in the unit cube as a string of bits or of integers (section 4.4.1)."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from hydrolek_drake.identification.search.genetic.settings import GeneticSettings


class Coding(Protocol):
    """What the operators need to know of a chromosome."""

    @property
    def elements(self) -> int:
        """Length of a chromosome."""

    @property
    def highest(self) -> int:
        """Largest value of an element; the least is 0."""

    def decode(self, chromosomes: np.ndarray) -> np.ndarray:
        """Places in the unit cube. # (k, elements) -> (k, parameters)."""

    def encode(self, units: np.ndarray) -> np.ndarray:
        """Nearest chromosomes. # (k, parameters) -> (k, elements)."""


@dataclass(frozen=True)
class BinaryCoding:
    """Multivariable binary string: `bits` elements of 0 or 1 for each parameter, most significant first.

    With Gray code, neighbouring values differ in one bit, which prevents the jumps that a carry makes.
    """

    parameters: int
    bits: int
    gray: bool

    @property
    def elements(self) -> int:
        """Length of a chromosome."""
        return self.parameters * self.bits

    @property
    def highest(self) -> int:
        """Largest value of an element."""
        return 1

    def decode(self, chromosomes: np.ndarray) -> np.ndarray:
        """Places in the unit cube. # (k, elements) -> (k, parameters)."""
        bits = np.asarray(chromosomes, dtype=np.int64).reshape(len(chromosomes), self.parameters, self.bits)
        if self.gray:
            bits = np.bitwise_xor.accumulate(bits, axis=2)
        weights = 2 ** np.arange(self.bits - 1, -1, -1)
        return (bits @ weights) / (2**self.bits - 1)

    def encode(self, units: np.ndarray) -> np.ndarray:
        """Nearest chromosomes. # (k, parameters) -> (k, elements)."""
        numbers = np.rint(np.clip(units, 0.0, 1.0) * (2**self.bits - 1)).astype(np.int64)
        if self.gray:
            numbers ^= numbers >> 1
        shifts = np.arange(self.bits - 1, -1, -1)
        return ((numbers[..., None] >> shifts) & 1).reshape(len(units), -1)


@dataclass(frozen=True)
class IntegerCoding:
    """One integer for each parameter."""

    parameters: int
    levels: int

    @property
    def elements(self) -> int:
        """Length of a chromosome."""
        return self.parameters

    @property
    def highest(self) -> int:
        """Largest value of an element."""
        return self.levels - 1

    def decode(self, chromosomes: np.ndarray) -> np.ndarray:
        """Places in the unit cube. # (k, elements) -> (k, parameters)."""
        return np.asarray(chromosomes, dtype=float) / self.highest

    def encode(self, units: np.ndarray) -> np.ndarray:
        """Nearest chromosomes. # (k, parameters) -> (k, elements)."""
        return np.rint(np.clip(units, 0.0, 1.0) * self.highest).astype(np.int64)


def coding_for(settings: GeneticSettings, parameters: int) -> Coding:
    """The coding that the settings name."""
    if settings.coding == "binary":
        return BinaryCoding(parameters, settings.bits, settings.gray)
    return IntegerCoding(parameters, settings.levels)
