"""Settings of the genetic algorithms, and those that the thesis found best."""

from dataclasses import dataclass

from hydrolek_drake.errors import InputError

CODINGS = ("binary", "integer")
CROSSOVERS = ("pointwise", "uniform")
MUTATIONS = ("chromosome", "element")


@dataclass(frozen=True)
class GeneticSettings:
    """How a genetic algorithm codes, mates and mutates.

    Attributes:
        coding: "binary" (multivariable binary string) or "integer".
        crossover: "pointwise" or "uniform".
        crossover_rate: P_c, probability that two parents are crossed rather than copied.
        crossover_points: cuts of the pointwise crossover.
        mutation_rate: P_m.
        mutation: what P_m is the probability of: "chromosome", that one element of a chromosome, drawn at
            random, is changed (section 4.4.1: "single elements may be randomly swapped"; the only reading in
            which section 4.5.4's rate of 0.5 leaves anything to inherit); "element", that each element is.
        population: chromosomes in a generation.
        bits: of each parameter in the binary coding.
        gray: whether neighbouring values differ in one bit.
        levels: of each parameter in the integer coding.
        elite: best chromosomes that are kept unchanged; the thesis's flow chart, figure 4.12, keeps none.
    """

    coding: str = "binary"
    crossover: str = "pointwise"
    crossover_rate: float = 0.8
    crossover_points: int = 3
    mutation_rate: float = 0.05
    mutation: str = "chromosome"
    population: int = 70
    bits: int = 16
    gray: bool = True
    levels: int = 65536
    elite: int = 0

    def __post_init__(self) -> None:
        for name, value, choices in (
            ("coding", self.coding, CODINGS),
            ("crossover", self.crossover, CROSSOVERS),
            ("mutation", self.mutation, MUTATIONS),
        ):
            if value not in choices:
                raise InputError(
                    f"genetic algorithm: {name} '{value}' is unknown; choose {', '.join(choices)}"
                )
        for name, rate in (("crossover_rate", self.crossover_rate), ("mutation_rate", self.mutation_rate)):
            if not 0.0 <= rate <= 1.0:
                raise InputError(f"genetic algorithm: {name} is {rate:g}; choose 0 to 1")
        if self.population < 4:
            raise InputError(f"genetic algorithm: population is {self.population}; choose 4 or more")
        if not 0 <= self.elite < self.population:
            raise InputError(f"genetic algorithm: elite is {self.elite}; choose 0 to {self.population - 1}")


SIMPLE = GeneticSettings()
"""Table 4.4, simple search."""

SIMPLE_INTEGER = GeneticSettings(coding="integer", crossover="uniform", mutation_rate=0.5)
"""Section 4.5.4."""

MULTI_TABLE = GeneticSettings(crossover_rate=0.4, mutation_rate=0.2, population=20)
"""Table 4.4, multi-objective search."""

MULTI_TEXT = GeneticSettings(crossover_rate=0.8, mutation_rate=0.2, population=70)
"""Section 4.5.5, multi-objective search; it contradicts Table 4.4."""
