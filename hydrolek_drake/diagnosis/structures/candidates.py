"""Which effects could explain a recording, how far each is searched, and where a search begins."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.effects import EFFECTS, Effect
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.parameter_set import Free, free_parameters
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.rig import declaration


@dataclass(frozen=True)
class Candidate:
    """One effect at one joint.

    Attributes:
        effect: the effect.
        joint: where it acts.
        free: its parameters with the range of the search.
        starts: full path -> value, where searches begin.
        utmost: full path -> how far the range of a parameter may be widened: what it can be at all, or the range that
            the rig states. A moment lies in the recording and has none.
        numbers: of the rig, which count with it and its like alone, see `Effect.reads`.
        beneath: no larger than this, its size says no more than what the model's own equations simplify.
    """

    effect: Effect
    joint: str
    free: tuple[Free, ...]
    starts: tuple[dict[str, float], ...]
    utmost: Mapping[str, tuple[float, float]] = field(compare=False)
    numbers: tuple[Free, ...] = ()
    beneath: float = 0.0

    cost: ClassVar[float] = 1.0
    """In effects."""

    @property
    def tried(self) -> tuple[float, ...]:
        """Multiples of its starts at which it is tried; those of one without a slope are close enough."""
        return (1.0,) if self.sudden else FITS.sizes

    @property
    def weakens(self) -> bool:
        """Whether it fades as its size grows."""
        return self.effect.weakens

    @property
    def sudden(self) -> bool:
        """Whether the joint moves otherwise as soon as it is there, see `Effect.sudden`."""
        return self.effect.sudden

    @property
    def step_share(self) -> float:
        """Steps so many times the rig's own resolve it."""
        return self.effect.step_share

    @property
    def stage(self) -> str:
        """Where it acts."""
        return self.effect.stage

    @property
    def id(self) -> str:
        """Id of the effect."""
        return self.effect.id

    @property
    def path(self) -> str:
        """Full path of the effect in a rig."""
        return f"joints.{self.joint}.effects.{self.effect.id}"

    @property
    def size_path(self) -> str:
        """Full path of the parameter that switches it on."""
        return f"{self.path}.{self.effect.size}"

    @property
    def label(self) -> str:
        """What tells it from others in tables."""
        return self.id

    @property
    def moments(self) -> tuple[Free, ...]:
        """Its parameters that say when something happens."""
        pairs = zip(self.free, self.effect.search.values(), strict=True)
        return tuple(free for free, search in pairs if search.moment)

    @property
    def searched(self) -> tuple[Free, ...]:
        """Those along which it is tried elsewhere too, since residuals have no slope there: moments."""
        return self.moments

    @property
    def size(self) -> Free:
        """The parameter that switches it on."""
        return next(free for free in self.free if free.path == self.size_path)

    def says_something(self, values: Mapping[str, float]) -> bool:
        """Whether its size, among fitted values, is beyond what the model's own equations simplify."""
        return self.beneath == 0.0 or abs(values[self.size_path] - self.effect.neutral_size) > self.beneath

    def is_special_case_of(self, other: Addition) -> bool:
        """Whether another effect at the same joint contains this one."""
        return isinstance(other, Candidate) and self.joint == other.joint and self.id in other.effect.contains

    def ended(self, values: Mapping[str, float]) -> list[Free]:
        """Its parameters, but for its size and moments, that were fitted to an end of what is searched.

        How quickly an oil warms up or how far a cushion reaches is no more than a natural scale of the machine allows;
        what asks for more may be something else, which the effect only imitates.

        Args:
            values: full path -> fitted value.
        """
        others = [f for f in self.free if f.path != self.size_path and f not in self.moments]
        places = [(free, free.to_unit(values[free.path])) for free in others]
        return [free for free, place in places if not FITS.tolerance < place < 1.0 - FITS.tolerance]

    def widened(self, values: Mapping[str, float]) -> "Candidate":
        """The same effect, searched further where a parameter lies at an end, as far as it can be at all.

        An effect's range follows from the machine's natural scales: what a worn machine may have. Where the best model
        has an effect at the far end of its range, the machine may have more of it, and what is added to that model only
        makes up for the rest. The same goes for what else an effect has, at either end.

        Args:
            values: full path -> fitted value.
        """
        return replace(self, free=tuple(self._further(f, values[f.path]) for f in self.free))

    def _further(self, free: Free, value: float) -> Free:
        """A parameter with a wider range if it lies at an end; a size not at that where the effect is off."""
        lowest, highest = self.utmost.get(free.path, (free.lower, free.upper))
        place = free.to_unit(value)
        size = free.path == self.size_path
        if place > 1.0 - FITS.tolerance and not (size and self.effect.weakens):
            upper = min(free.upper * FITS.wider, highest)
            mirrored = size and free.lower < 0.0
            return replace(
                free, lower=max(free.lower * FITS.wider, lowest) if mirrored else free.lower, upper=upper
            )
        if place < FITS.tolerance and free.lower < 0.0:
            upper = min(free.upper * FITS.wider, highest) if size else free.upper
            return replace(free, lower=max(free.lower * FITS.wider, lowest), upper=upper)
        if place < FITS.tolerance and free.lower > 0.0 and (not size or self.effect.weakens):
            return replace(free, lower=max(free.lower / FITS.wider, lowest))
        return free


def candidates_of(rig: Rig, joint: str, scales: Scales) -> tuple[Candidate, ...]:
    """Every effect that can act on this joint and is not switched on in the rig yet.

    The range of a parameter is the rig's own if it states one, else the effect's multiple of the machine's
    natural scale. Effects on the supply, which all joints share, carry the name of the rig's first joint.
    """
    on = rig.effects_on(joint)
    found = []
    for effect in EFFECTS.values():
        if effect.id in on or not effect.search or not _acts(effect, rig, joint):
            continue
        candidate = _candidate(effect, rig, rig.owner(effect, joint), scales)
        if candidate is not None:
            found.append(candidate)
    return tuple(found)


def _acts(effect: Effect, rig: Rig, joint: str) -> bool:
    if any(rig.variant(joint, section) not in names for section, names in effect.needs.items()):
        return False
    searched = [rig.variant(joint, section) in names for section, names in effect.searched_on.items()]
    if searched and not any(searched):
        return False
    if (
        "cavity_refilled" in effect.hooks
    ):  # beside a number of the rig that is fitted, or says that all of it is
        own = rig.entries["fluid.cavity_refilled"]
        return own.range is None and own.value < 1.0
    if "linkage_gap" in effect.hooks:  # play needs something that moves within it
        return rig.value(f"joints.{joint}.linkage.play_inertia") > 0.0
    return True


def _candidate(effect: Effect, rig: Rig, joint: str, scales: Scales) -> Candidate | None:
    free: list[Free] = []
    utmost: dict[str, tuple[float, float]] = {}
    starts: list[list[tuple[str, float]]] = []
    for name, search in effect.search.items():
        path = f"joints.{joint}.effects.{effect.id}.{name}"
        entry, declared = rig.entries[path], declaration(rig, path)
        lower, upper, begin = scales.range_of(search)
        log = search.log
        if entry.range is not None:
            lower, upper = entry.range
            log = entry.scale == "log"
        lower, upper = max(lower, declared.lowest), min(upper, declared.highest)
        if not search.moment:
            stated = entry.range is not None
            utmost[path] = (lower, upper) if stated else (declared.lowest, declared.highest)
        if not (math.isfinite(lower) and math.isfinite(upper) and lower < upper):
            return None
        free.append(Free(path, lower, upper, log))
        inside = sorted({min(max(value, lower), upper) for value in begin})
        starts.append([(path, value) for value in inside])
    return Candidate(
        effect,
        joint,
        tuple(free),
        tuple(dict(c) for c in itertools.product(*starts)),
        utmost,
        _numbers(effect, rig, joint),
        getattr(scales, effect.beneath) if effect.beneath else 0.0,
    )


def _numbers(effect: Effect, rig: Rig, joint: str) -> tuple[Free, ...]:
    """Numbers that it reads and that the rig lets vary."""
    ranged = rig.free_parameters()
    paths = [f"joints.{joint}.{name}" for name in effect.reads]
    return free_parameters(rig, [path for path in paths if path in ranged])


Exchange = tuple[Addition, Candidate, tuple[Addition, ...]]
"""An effect, the one in its place, and all effects with that one at the end."""


def widenings(effects: Sequence[Addition], candidates: Sequence[Candidate]) -> list[Exchange]:
    """Each effect that another one contains, with that other one in its place."""
    return _exchanges(effects, candidates, lambda own, other: own.is_special_case_of(other))


def narrowings(effects: Sequence[Addition], candidates: Sequence[Candidate]) -> list[Exchange]:
    """Each effect that contains another one, with that special case in its place."""
    return _exchanges(effects, candidates, lambda own, other: other.is_special_case_of(own))


def _exchanges(
    effects: Sequence[Addition], candidates: Sequence[Candidate], may: Callable[[Addition, Candidate], bool]
) -> list[Exchange]:
    return [
        (effect, other, (*(rest for rest in effects if rest is not effect), other))
        for effect in effects
        for other in candidates
        if may(effect, other)
    ]


def redundant(effects: Sequence[Addition], candidate: Addition) -> bool:
    """Whether an effect says nothing new beside others, because one of them contains it or is contained in it."""
    return any(one_contains_the_other(c, candidate) for c in effects)


def one_contains_the_other(first: Addition, second: Addition) -> bool:
    """Whether one of two effects at the same joint contains the other."""
    return first.is_special_case_of(second) or second.is_special_case_of(first)
