"""What may change between recordings of a healthy machine: its load, its oil's temperature.

Such a number says nothing of the machine's health. It is fitted to every recording anew, the reference recordings
included, and is known beforehand by its range alone. An effect of that kind, a payload say, then belongs to every
model and is no longer asked for. In the fit of the reference each recording has values of its own for these numbers
beside those that all share; what is kept is the marginal posterior of the shared ones (the Schur complement of the
information).
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import SPREAD, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.parameter_set import Free, ParameterSet, free_of_joints
from hydrolek_drake.rigs import Rig


@dataclass(frozen=True)
class Changing:
    """Numbers that change between recordings.

    Attributes:
        rig: the machine, with the effects among them switched on and given a range.
        paths: full paths of these numbers.
    """

    rig: Rig
    paths: tuple[str, ...] = ()


def changing_of(rig: Rig, names: Sequence[str], scales: Mapping[str, Scales]) -> Changing:
    """What the user said may change.

    Args:
        rig: the machine.
        names: ids of effects, and paths, or parts of paths, of parameters that have a range.
        scales: joint -> natural scales.

    Raises:
        InputError: no such effect or parameter.
    """
    if not names:
        return Changing(rig)
    entries, paths = dict(rig.entries), []
    of_rig = [free.path for free in free_of_joints(rig, set(scales))]
    possible = {c.size_path: c for joint in scales for c in candidates_of(rig, joint, scales[joint])}
    for name in names:
        found = [c for c in possible.values() if name in (c.id, c.path)]
        own = [path for path in of_rig if contains(path, name)]
        if not found and not own:
            raise InputError(
                f"--changes {name}: neither an effect of this rig nor a parameter with a range; "
                f"{', '.join([*sorted({c.id for c in possible.values()}), *of_rig])}"
            )
        paths += own
        for candidate in found:
            for free in candidate.free:
                entry = replace(entries[free.path], same_as=None)
                if free in candidate.moments:  # what changes is there from the beginning
                    entries[free.path] = replace(entry, range=None)
                    continue
                ends, scale = (free.lower, free.upper), "log" if free.log else "linear"
                begin = candidate.starts[0][free.path]
                entries[free.path] = replace(entry, value=begin, range=ends, scale=scale)
                paths.append(free.path)
    return Changing(replace(rig, entries=entries), tuple(dict.fromkeys(paths)))


def contains(path: str, name: str) -> bool:
    """Whether some consecutive parts of a path are these."""
    whole, parts = path.split("."), name.split(".")
    return any(whole[i : i + len(parts)] == parts for i in range(len(whole) - len(parts) + 1))


class PerRecording(ParameterSet):
    """Records of all joints, once for every recording: shared numbers, and in each one its own of those that change.

    The record of joint j in the k-th recording is number k * joints + j. Shared parameters come first.
    """

    def __init__(
        self,
        rig: Rig,
        free: Sequence[Free],
        changing: Sequence[str],
        recordings: Sequence[str],
        known: dict[Free, tuple[np.ndarray, np.ndarray]],
    ) -> None:
        """Find where each parameter stands.

        Args:
            rig: the machine.
            free: what is searched, those that change among them.
            changing: paths of those.
            recordings: names of the recordings.
            known: as of `ParameterSet`.
        """
        super().__init__(rig, free, known)
        joints, count = len(rig.joints), len(recordings)
        now = dict(zip(self.free, zip(self._places, super().arrivals.tolist(), strict=True), strict=True))
        copied = copies_of(free, changing, recordings)
        self.free, self._places = tuple(each for each, _, _ in copied), []
        self._origins = tuple(origin.path for _, origin, _ in copied)
        self._arrive = np.array([now[origin][1] for _, origin, _ in copied], dtype=bool)
        for _, origin, recording in copied:
            rows, columns = now[origin][0]
            at = range(count) if recording is None else [recordings.index(recording)]
            self._places.append((np.concatenate([rows + k * joints for k in at]), np.tile(columns, len(at))))
        self._base = np.tile(self._base, count)

    @property
    def arrivals(self) -> np.ndarray:
        """Which of them say when commands arrive. # (n,) truth values."""
        return self._arrive

    def unit(self, values: Mapping[str, float] | None = None) -> np.ndarray:
        """Place of the given values, or of the rig's own, pulled into the cube."""
        own = {p.path: self.rig.value(path) for p, path in zip(self.free, self._origins, strict=True)}
        return super().unit({**own, **(values or {})})


def copies_of(
    free: Sequence[Free], changing: Sequence[str], recordings: Sequence[str]
) -> list[tuple[Free, Free, str | None]]:
    """Shared parameters, then those of single recordings: each with what it is in the rig, and its recording."""
    shared: list[tuple[Free, Free, str | None]] = [(f, f, None) for f in free if f.path not in changing]
    own = [f for f in free if f.path in changing]
    return shared + [(replace(f, path=f"{f.path} in {name}"), f, name) for f in own for name in recordings]


class ReferenceBench(Workbench):
    """Fits of the nominal model to reference recordings in each of which some numbers have values of their own."""

    def __init__(
        self,
        rig: Rig,
        free: Sequence[Free],
        changing: Sequence[str],
        training: Sequence[Experiment],
        pool: Executor,
        cores: int,
    ) -> None:
        """Prepare.

        Args:
            rig: the machine.
            free: its parameters.
            changing: paths of those that change.
            training: the recordings.
            pool: threads.
            cores: that roll out at the same time.
        """
        names = list(dict.fromkeys(e.name for e in training))
        joints = len(rig.joints)
        placed = [replace(e, index=e.index % joints + names.index(e.name) * joints) for e in training]
        super().__init__(rig, [each for each, _, _ in copies_of(free, changing, names)], placed, pool, cores)
        self._free, self._changing = tuple(free), tuple(changing)
        self._parameters = PerRecording(rig, free, changing, names, {})

    def with_training(
        self, training: Sequence[Experiment], *, signals_apart: bool | None = None
    ) -> "ReferenceBench":
        """Another one for other recordings of the same machine."""
        return ReferenceBench(self.rig, self._free, self._changing, training, self.pool, self.cores)

    def values_in(self, hypothesis: Hypothesis, recording: str) -> dict[str, float]:
        """Full path -> value of a fit in a recording: its own of those that change."""
        ending = f" in {recording}"
        values = {p: v for p, v in hypothesis.values.items() if " in " not in p}
        own = {p.removesuffix(ending): v for p, v in hypothesis.values.items() if p.endswith(ending)}
        return {**values, **own}

    def parameters(self, effects: Sequence[Addition]) -> ParameterSet:
        """The searched parameters of the nominal model; there are none of effects."""
        assert not effects, "only the nominal model is fitted to a reference whose numbers change"
        return self._parameters


def kept_of(
    parameters: ParameterSet, changing: Sequence[str], unit: np.ndarray, information: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What a fit of `ReferenceBench` says of a later recording's numbers: mean and information in the rig's order.

    Of those that change no more is known than where the rig has them and their ranges, as in any fit (`SPREAD`); the
    others are told by the marginal of the fit.

    Args:
        parameters: of the rig, n of them.
        changing: paths of those that change.
        unit: where the fit ended, shared parameters first. # (m,)
        information: of that. # (m, m)
    """
    stays = np.array([f.path not in changing for f in parameters.free])
    count = int(stays.sum())
    across = information[:count, count:]
    marginal = information[:count, :count] - across @ np.linalg.solve(information[count:, count:], across.T)
    mean, whole = parameters.unit(), np.eye(stays.size) / SPREAD**2
    mean[stays] = unit[:count]
    whole[np.ix_(stays, stays)] = 0.5 * (marginal + marginal.T)
    return mean, whole
