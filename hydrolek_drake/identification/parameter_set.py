"""Which parameters of a rig are searched, and how they are mapped to the unit cube."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.records import copied, flat
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.rig import declaration


@dataclass(frozen=True)
class Free:
    """One parameter that is searched.

    Attributes:
        path: its full path in the rig.
        lower: lower end of the range (SI).
        upper: upper end.
        log: whether the range is searched on a logarithmic scale.
    """

    path: str
    lower: float
    upper: float
    log: bool = False

    def __post_init__(self) -> None:
        if not (math.isfinite(self.lower) and math.isfinite(self.upper) and self.lower < self.upper):
            raise InputError(
                f"{self.path}: range [{self.lower:g}, {self.upper:g}] is empty or has no end; "
                "write a finite range: [low, high]"
            )
        if self.log and self.lower <= 0.0:
            raise InputError(
                f"{self.path}: a logarithmic range must be above zero, not [{self.lower:g}, {self.upper:g}]"
            )

    def from_unit(self, u: float) -> float:
        """Value (SI) at a place between 0 (lower end) and 1 (upper end)."""
        if self.log:
            return self.lower * (self.upper / self.lower) ** u
        return self.lower + u * (self.upper - self.lower)

    def to_unit(self, value: float) -> float:
        """Place of a value in the range; outside 0 to 1 if it lies outside."""
        if self.log:
            return math.log(value / self.lower) / math.log(self.upper / self.lower)
        return (value - self.lower) / (self.upper - self.lower)

    def slope(self, u: float) -> float:
        """Change of the value with its place, for intervals in physical units."""
        if self.log:
            return self.from_unit(u) * math.log(self.upper / self.lower)
        return self.upper - self.lower


class ParameterSet:
    """A rig's joint records as a function of the searched parameters.

    A parameter may stand in several places of the records: in every joint if it belongs to the supply, and
    in each parameter that follows it (`same_as`).
    """

    def __init__(
        self, rig: Rig, free: Sequence[Free], known: dict[Free, tuple[np.ndarray, np.ndarray]] | None = None
    ) -> None:
        """Find where each parameter stands.

        Args:
            rig: the machine.
            free: what is searched.
            known: where parameters of this rig stand as far as it was found before, and that is found here.

        Raises:
            InputError: no such parameter, or one that does not reach the compiled physics.
        """
        self.rig = rig
        self.free = tuple(free)
        self._base = rig.records()
        vectors = flat(self._base)
        places = {} if known is None else known
        for parameter in self.free:
            if parameter not in places:
                places[parameter] = _places(rig, vectors, parameter)
        self._places = [places[parameter] for parameter in self.free]

    def __len__(self) -> int:
        return len(self.free)

    @property
    def paths(self) -> tuple[str, ...]:
        """Full paths in the order of the unit vector."""
        return tuple(parameter.path for parameter in self.free)

    @property
    def arrivals(self) -> np.ndarray:
        """Which of them say when commands arrive. # (n,) truth values."""
        return np.array([self._arrives(p.path) for p in self.free], dtype=bool)

    def _arrives(self, path: str) -> bool:
        return declaration(self.rig, path).arrival

    def per_place(self, unit: np.ndarray) -> np.ndarray:
        """Change of each parameter's value (SI) with its place in the unit cube. # (n,)."""
        return np.array([p.slope(float(u)) for p, u in zip(self.free, unit, strict=True)])

    def records(self, unit: np.ndarray) -> np.ndarray:
        """Records of all joints, shape (n joints,), for a place in the unit cube."""
        records = copied(self._base)
        self._set(records, unit)
        return records

    def _set(self, records: np.ndarray, unit: np.ndarray) -> None:
        """Write the parameters of the rig into records, for a place in their unit cube."""
        vectors = flat(records)
        for parameter, (joints, positions), u in zip(self.free, self._places, unit, strict=False):
            vectors[joints, positions] = parameter.from_unit(float(u))

    def values(self, unit: np.ndarray) -> dict[str, float]:
        """Full path -> value (SI)."""
        return {p.path: p.from_unit(float(u)) for p, u in zip(self.free, unit, strict=True)}

    def unit(self, values: Mapping[str, float] | None = None) -> np.ndarray:
        """Place of the given values, or of the rig's own, pulled into the cube."""
        given = values or {}
        places = [
            p.to_unit(max(v, p.lower) if p.log else v)
            for p in self.free
            for v in (given[p.path] if p.path in given else self.rig.value(p.path),)
        ]
        return np.clip(np.array(places), 0.0, 1.0)

    def with_rig_values(self, unit: np.ndarray) -> Rig:
        """The rig with these values."""
        return self.rig.with_values(self.values(unit))


def free_parameters(rig: Rig, paths: Sequence[str] | None = None) -> tuple[Free, ...]:
    """The rig's free parameters, or those named.

    Args:
        rig: the machine.
        paths: full or short paths; None for every parameter with a range but those of effects that are off: there
            a range tells how far a diagnosis may look.

    Raises:
        InputError: no such parameter, or one without a range.
    """
    ranged = rig.free_parameters()
    if paths is None:
        off = parameters_off(rig)
        chosen = [path for path in ranged if path not in off]
        if not chosen:
            raise InputError(
                f"rig {rig.name} has no free parameter; give one a range: [low, high] in {rig.path}"
            )
    else:
        chosen = [rig.full_path(path) for path in paths]
    free = []
    for path in chosen:
        if path not in ranged:
            raise InputError(
                f"{path} has no range in rig {rig.name}, so it cannot be fitted; "
                f"parameters with a range: {', '.join(ranged) or 'none'}"
            )
        entry = ranged[path]
        assert entry.range is not None
        free.append(Free(path, *entry.range, log=entry.scale == "log"))
    return tuple(free)


def free_of_joints(rig: Rig, joints: Collection[str]) -> tuple[Free, ...]:
    """The rig's free parameters of some joints, and those that all joints share: a recording tells nothing of others.

    Args:
        rig: the machine.
        joints: that were driven.
    """
    return tuple(
        free
        for free in free_parameters(rig)
        if not free.path.startswith("joints.") or free.path.split(".")[1] in joints
    )


def parameters_off(rig: Rig) -> list[str]:
    """Full paths of parameters that have a range but belong to an effect that is off, or that only such read."""
    on = {(rig.owner(EFFECTS[id_], joint), id_) for joint in rig.joints for id_ in rig.effects_on(joint)}
    of_those_on = tuple(f"joints.{joint}.effects.{id_}." for joint, id_ in on)
    read = {f"joints.{joint}.{name}" for joint, id_ in on for name in EFFECTS[id_].reads}
    read_by_any = {f"joints.{j}.{name}" for j in rig.joints for e in EFFECTS.values() for name in e.reads}
    return [
        path
        for path in rig.free_parameters()
        if (".effects." in path and not path.startswith(of_those_on))
        or (path in read_by_any and path not in read)
    ]


def _places(rig: Rig, vectors: np.ndarray, parameter: Free) -> tuple[np.ndarray, np.ndarray]:
    """Joint and position of every number of the records that this parameter sets."""
    now = rig.value(parameter.path)
    middle = parameter.from_unit(0.5)
    probe = middle if middle != now else parameter.from_unit(0.25)
    declared = declaration(rig, rig.full_path(parameter.path))
    if not declared.lowest <= parameter.lower < parameter.upper <= declared.highest:
        raise InputError(
            f"{parameter.path}: range [{parameter.lower:g}, {parameter.upper:g}] goes beyond what is possible, "
            f"{declared.lowest:g} to {declared.highest:g}"
        )
    changed = flat(rig.with_values({parameter.path: probe}).records())
    same = (changed == vectors) | (np.isnan(changed) & np.isnan(vectors))
    joints, positions = np.nonzero(~same)
    if not len(joints) or not np.all(changed[joints, positions] == probe):
        raise InputError(
            f"{parameter.path} cannot be fitted: it does not enter the compiled physics by itself"
        )
    return joints, positions
