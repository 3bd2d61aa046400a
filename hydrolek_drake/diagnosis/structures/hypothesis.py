"""A structure that was fitted: the nominal model with what is added to it, and how well it follows the data."""

from collections.abc import Iterable
from dataclasses import dataclass

from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.identification.parameter_set import Free


@dataclass(frozen=True)
class Hypothesis:
    """The nominal model with some effects, fitted.

    Attributes:
        effects: what is added to the nominal model; empty for the nominal model itself.
        values: full path -> fitted value (SI), nominal parameters first.
        fit: how well it follows the training data, and its Jacobian.
        step: integration step with which it was fitted [s].
    """

    effects: tuple[Addition, ...]
    values: dict[str, float]
    fit: Fit
    step: float

    @property
    def ids(self) -> frozenset[str]:
        """What identifies it: id and joint of its effects."""
        return key_of(self.effects)

    @property
    def listed(self) -> tuple[Candidate, ...]:
        """Its effects."""
        return tuple(c for c in self.effects if isinstance(c, Candidate))

    def without(self, effect: Addition) -> tuple[Addition, ...]:
        """Its effects but for one."""
        return tuple(c for c in self.effects if c is not effect)

    def values_without(self, *additions: Addition) -> dict[str, float]:
        """Its values but for those of some of its additions: full path -> value."""
        own = tuple(c.path + "." for c in additions)
        return {path: value for path, value in self.values.items() if not path.startswith(own)}

    @property
    def label(self) -> str:
        """What tells it from others in tables."""
        return " + ".join(c.label for c in self.effects) or "nominal model"

    @property
    def extra(self) -> int:
        """Parameters that the nominal model does not have."""
        return sum(len(candidate.free) for candidate in self.effects)


def key_of(effects: Iterable[Addition]) -> frozenset[str]:
    """A set of effects, whatever their order."""
    return frozenset(candidate.size_path for candidate in effects)


def moments_of(effects: Iterable[Addition]) -> list[Free]:
    """Parameters of some effects that say when something happens."""
    return [free for candidate in effects for free in candidate.moments]
