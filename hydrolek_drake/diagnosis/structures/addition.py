"""What may be added to the nominal model: an effect, a term of a law, or commands that got lost."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from hydrolek_drake.identification.parameter_set import Free


class Addition(Protocol):
    """One addition at one joint, with its own parameters."""

    @property
    def joint(self) -> str:
        """Where it acts."""
        ...

    @property
    def cost(self) -> float:
        """In effects."""
        ...

    @property
    def sudden(self) -> bool:
        """Whether the joint moves otherwise as soon as it is there."""
        ...

    @property
    def step_share(self) -> float:
        """Steps so many times the rig's own resolve it."""
        ...

    @property
    def beneath(self) -> float:
        """No larger than this, its size says no more than what the model's own equations simplify."""
        ...

    @property
    def stage(self) -> str:
        """Stage of the joint's chain."""
        ...

    @property
    def id(self) -> str:
        """As in reports."""
        ...

    @property
    def label(self) -> str:
        """What tells it from others in tables."""
        ...

    @property
    def path(self) -> str:
        """Full path of its parameters."""
        ...

    @property
    def size_path(self) -> str:
        """What tells it from other additions: full path of the parameter that switches it on."""
        ...

    @property
    def free(self) -> tuple[Free, ...]:
        """Its parameters with the ranges of the search."""
        ...

    @property
    def moments(self) -> tuple[Free, ...]:
        """Those that least squares cannot move, since they say when something happens."""
        ...

    @property
    def searched(self) -> tuple[Free, ...]:
        """Those along which it is tried elsewhere too."""
        ...

    def says_something(self, values: Mapping[str, float]) -> bool:
        """Whether its size, among fitted values, is beyond what the model's own equations simplify."""
        ...

    def is_special_case_of(self, other: "Addition") -> bool:
        """Whether another addition contains this one."""
        ...

    def widened(self, values: Mapping[str, float]) -> "Addition":
        """The same with wider ranges where a fitted value lies at an end of one."""
        ...


class Sized(Addition, Protocol):
    """An addition with one parameter that switches it on."""

    @property
    def weakens(self) -> bool:
        """Whether it fades as its size grows."""
        ...

    @property
    def size(self) -> Free:
        """That parameter."""
        ...

    @property
    def tried(self) -> tuple[float, ...]:
        """Multiples of its starts at which it is tried."""
        ...

    @property
    def starts(self) -> tuple[dict[str, float], ...]:
        """Full path -> value, where searches begin."""
        ...


def names_of(effects: Sequence[Addition]) -> str:
    """A structure in a line of the log."""
    return "+".join(c.id for c in effects) or "nominal"
