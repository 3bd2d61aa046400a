"""Terms of a law as additions to a structure, beside effects: for physics that is in no list.

A term is a product of factors of `physics.law` at one input from outside, with an amplitude (a periodic one: of sine
and cosine, and a frequency) and the numbers of its place. The joint's record holds it, so that a structure with terms
is fitted, searched and judged as one with effects is.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from hydrolek_drake.diagnosis.settings import FITS, GAINS, LOCATING
from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.diagnosis.structures.term_forms import Span, Term, law_record
from hydrolek_drake.identification.parameter_set import Free, ParameterSet
from hydrolek_drake.physics.law import PLACED, TERM_NAMES
from hydrolek_drake.physics.records import copied
from hydrolek_drake.rigs import Rig


@dataclass(frozen=True)
class LawTerm:
    """A term at one input of a joint.

    Attributes:
        input: what it gives.
        term: its form; None for a periodic one.
        joint: where it acts.
        span: what its variables are told in.
        frequency: of a periodic one, first guess [Hz].
        breadth: half of the range about it in which it is fitted [Hz].
        seen: amplitudes, in scales of the input, that the innovations of an observer ask for; None if nobody looked.
        across: the input on the other side of the linkage, for a force; None for what is no force.
    """

    input: Input
    term: Term | None
    joint: str
    span: Span = field(compare=False, repr=False)
    frequency: float = 0.0
    breadth: float = LOCATING.breadth_hz
    seen: tuple[float, ...] | None = field(default=None, compare=False)
    across: Input | None = field(default=None, compare=False)

    cost: ClassVar[float] = GAINS.law
    """In effects."""

    tried: ClassVar[tuple[float, ...]] = (1.0,)
    weakens: ClassVar[bool] = False
    sudden: ClassVar[bool] = False
    step_share: ClassVar[float] = 1.0
    moments: ClassVar[tuple[Free, ...]] = ()
    searched: ClassVar[tuple[Free, ...]] = ()

    @property
    def beneath(self) -> float:
        """No larger than this, its amplitude makes no difference in practice."""
        return self.input.beneath

    @property
    def stage(self) -> str:
        """Where it acts."""
        return self.input.stage

    @property
    def is_listed(self) -> bool:
        """Whether an effect of the list does the same (`Term.is_listed`)."""
        return self.term is not None and self.term.is_listed(self.input)

    @property
    def id(self) -> str:
        """As in reports."""
        return f"unlisted.{self.input.stage}"

    @property
    def label(self) -> str:
        """What tells it from others in tables."""
        return f"{self.id}: {self.name}"

    @property
    def name(self) -> str:
        """Of its form."""
        if self.term is None:
            return f"sine({self.frequency:.2f} Hz)"
        return f"{self.term.name}@{self.term.centre:g}" if self.term.place in PLACED else self.term.name

    @property
    def path(self) -> str:
        """What stands for it where an effect has its path in a rig."""
        return f"joints.{self.joint}.law.{self.input.probe}.{self.name}"

    @property
    def size_path(self) -> str:
        """Of its amplitude."""
        return f"{self.path}.amplitude"

    @property
    def free(self) -> tuple[Free, ...]:
        """Its parameters with the ranges of the search."""
        scale = self.input.scale
        low = 0.0 if self.input.one_sided else -scale
        found = [Free(self.size_path, low, scale)]
        if self.term is None:
            found.append(Free(f"{self.path}.cosine", -scale, scale))
            found.append(
                Free(f"{self.path}.frequency", self.frequency - self.breadth, self.frequency + self.breadth)
            )
        else:
            ranges = {
                "centre": Free(f"{self.path}.centre", -1.0, 1.0),
                "reach": Free(
                    f"{self.path}.reach", self.term.reach / FITS.wider, self.term.reach * FITS.wider, log=True
                ),
            }
            found += [ranges[name] for name in PLACED.get(self.term.place, ())]
        return tuple(found)

    @property
    def size(self) -> Free:
        """The parameter that switches it on."""
        return self.free[0]

    @property
    def starts(self) -> tuple[dict[str, float], ...]:
        """Where searches begin."""
        signs = (1.0,) if self.input.one_sided else (1.0, -1.0)
        if self.term is None:
            turns = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
            sizes: list[tuple[float, ...]] = [
                (LOCATING.sizes[1] * sine, LOCATING.sizes[1] * cosine) for sine, cosine in turns
            ]
        else:
            sizes = [(sign * size,) for size in LOCATING.sizes for sign in signs]
        if self.seen is not None:
            sizes = [tuple(size * seen for seen in self.seen) for size in (1.0, 0.3, 3.0)] + sizes[-2:]
        paths = [self.size_path, f"{self.path}.cosine"]
        rest = self.neutral()
        found = []
        for each in sizes:
            values = dict(
                zip(paths, (float(np.clip(s, -0.9, 0.9)) * self.input.scale for s in each), strict=False)
            )
            found.append({**rest, **values})
        return tuple(found)

    def moved_across(self, values: Mapping[str, float]) -> "tuple[LawTerm, dict[str, float]] | None":
        """The same force on the other side of the linkage, and its values there; None for what is no force.

        Args:
            values: full path -> value, with the term's own.
        """
        if self.across is None:
            return None
        other = replace(self, input=self.across, across=self.input)
        told = {free.path: values[free.path] for free in self.free}
        forces = {self.size_path, f"{self.path}.cosine"}
        scale = other.input.scale / self.input.scale
        return other, {
            other.path + path[len(self.path) :]: value * (scale if path in forces else 1.0)
            for path, value in told.items()
        }

    def neutral(self) -> dict[str, float]:
        """Full path -> value at which it does nothing."""
        values = {free.path: 0.0 for free in self.free}
        if self.term is None:
            values[f"{self.path}.frequency"] = self.frequency
        for name in PLACED.get(self.term.place, ()) if self.term is not None else ():
            values[f"{self.path}.{name}"] = getattr(self.term, name)
        return values

    def says_something(self, values: Mapping[str, float]) -> bool:
        """Whether it is more than what makes no difference in practice; see `Candidate`."""
        amplitude = math.hypot(values[self.size_path], values.get(f"{self.path}.cosine", 0.0))
        return self.beneath == 0.0 or amplitude > self.beneath

    def is_special_case_of(self, other: object) -> bool:
        """Whether another addition contains this one: no term does."""
        return False

    def widened(self, values: Mapping[str, float]) -> "LawTerm":
        """The same with a larger scale, where an amplitude lies at the end of what is searched."""
        sizes = [free for free in self.free if free.path in (self.size_path, f"{self.path}.cosine")]
        if all(abs(values[free.path]) < (1.0 - FITS.tolerance) * free.upper for free in sizes):
            return self
        return replace(self, input=replace(self.input, scale=FITS.wider * self.input.scale))

    def row(self, values: Mapping[str, float]) -> np.ndarray:
        """As the physics takes it. # (1,) of `physics.law.LAW`."""
        size = values[self.size_path]
        if self.term is None:
            return law_record(
                self.input.probe,
                self.span,
                None,
                size,
                values[f"{self.path}.cosine"],
                values[f"{self.path}.frequency"],
            )
        row = law_record(self.input.probe, self.span, self.term, size)
        reach = self.span.at(self.input.probe)
        for name in PLACED.get(self.term.place, ()):
            value = values[f"{self.path}.{name}"]
            row[name] = reach.position(value) if name == "centre" else reach.distance(value)
        return row


class WithTerms(ParameterSet):
    """A rig's joint records as a function of searched parameters, those of terms of laws among them."""

    def __init__(
        self,
        rig: Rig,
        free: Sequence[Free],
        terms: Sequence[LawTerm],
        known: dict[Free, tuple[np.ndarray, np.ndarray]] | None = None,
    ) -> None:
        """Find where each parameter stands.

        Args:
            rig: the machine.
            free: of the rig.
            terms: whose own parameters follow these.
            known: as of `ParameterSet`.
        """
        super().__init__(rig, free, known)
        self._of_rig = len(self.free)
        self.terms = tuple(terms)
        self.free = (*self.free, *(each for term in terms for each in term.free))
        self._neutral = {path: value for term in terms for path, value in term.neutral().items()}

    def _arrives(self, path: str) -> bool:
        return path not in self._neutral and super()._arrives(path)

    def records(self, unit: np.ndarray) -> np.ndarray:
        """Records of all joints, shape (n joints,), for a place in the unit cube."""
        records = copied(self._base)
        self._set(records, unit[: self._of_rig])
        values = {
            p.path: p.from_unit(float(u))
            for p, u in zip(self.free[self._of_rig :], unit[self._of_rig :], strict=True)
        }
        taken: dict[str, int] = {}
        for term in self.terms:
            at = self.rig.joints.index(term.joint)
            first = taken.get(term.joint, len(self.rig.laws.get(term.joint, ())))
            records["law"][TERM_NAMES[first]][at] = term.row(values)[0]
            taken[term.joint] = first + 1
        return records

    def unit(self, values: Mapping[str, float] | None = None) -> np.ndarray:
        """Place of the given values, or of the rig's own and of terms that do nothing, pulled into the cube."""
        return super().unit({**self._neutral, **(values or {})})


ADDED = (".effects.", ".law.", ".lost.")
"""In the paths of parameters that the nominal model does not have."""


def of_additions(values: Mapping[str, float]) -> dict[str, float]:
    """Those of some values that belong to what is added to the nominal model."""
    return {path: value for path, value in values.items() if any(part in path for part in ADDED)}
