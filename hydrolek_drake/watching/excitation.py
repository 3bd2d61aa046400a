"""Whether a reference tells the machine's own numbers as surely as later recordings do, and what it lacks.

A reference that is short, or in which a joint hardly moves, leaves numbers uncertain that later recordings tell (it is
not persistently exciting; Ljung, System Identification, 1999, section 13.2). What it lacks is told by number: how sure
either is, how much longer a reference of the same movements would have to be, since information grows with time, or
that it takes other movements.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from hydrolek_drake.diagnosis.structures.workbench import SPREAD
from hydrolek_drake.watching.settings import NAMED, POORER, UNTOLD


class Told(Protocol):
    """What one recording says of the machine's own numbers (`asking.Answer`)."""

    @property
    def told_alone(self) -> Mapping[str, float]:
        """Full path -> standard deviation of the number by this recording alone, in ranges."""

    @property
    def seconds(self) -> float:
        """Its length [s]."""


@dataclass(frozen=True)
class ReferenceTold:
    """How surely the reference tells the machine's own numbers.

    Attributes:
        deviations: full path -> standard deviation, in ranges.
        drift: full path -> standard deviation by which the number may differ from one recording to another, in ranges.
        seconds: length of all reference recordings [s].
    """

    deviations: Mapping[str, float]
    drift: Mapping[str, float]
    seconds: float


@dataclass(frozen=True)
class Lacking:
    """A number that later recordings tell more surely than the reference does, and than it may drift.

    Attributes:
        path: full path of the number.
        deviation: its standard deviation by the reference, in ranges.
        later: the same by one later recording alone, median.
        longer: how many times as long a reference of the same movements would tell it as surely; infinite where it
            tells nothing at all.
        moves: whether the reference's movements tell as much of it a second as the later ones do.
    """

    path: str
    deviation: float
    later: float
    longer: float
    moves: bool


def told_alone(paths: Sequence[str], slopes: np.ndarray, scale: float) -> dict[str, float]:
    """How surely a recording by itself tells the machine's own numbers, beside what their ranges say.

    Args:
        paths: of the numbers.
        slopes: of the residuals with them. # (values, n)
        scale: squares that count as one.

    Returns:
        Full path -> standard deviation, in ranges.
    """
    information = slopes.T @ slopes / scale + np.eye(len(paths)) / SPREAD**2
    deviations = np.sqrt(np.diag(np.linalg.inv(information)))
    return dict(zip(paths, deviations.tolist(), strict=True))


def lacking(told: ReferenceTold, answers: Sequence[Told]) -> list[Lacking]:
    """What a reference lacks, the least known first.

    Args:
        told: by the reference.
        answers: of later recordings.
    """
    found = []
    for path, deviation in told.deviations.items():
        own = [(a.told_alone[path], a.seconds) for a in answers if path in a.told_alone]
        if not own:
            continue
        later, seconds = (float(np.median(column)) for column in np.transpose(own))
        needed = max(later, told.drift[path])
        if deviation <= needed:
            continue
        share = (deviation / later) ** 2 * told.seconds / seconds
        longer = np.inf if deviation > UNTOLD * SPREAD else (deviation / needed) ** 2
        found.append(Lacking(path, deviation, later, longer, share < POORER))
    return sorted(found, key=lambda each: -each.deviation / each.later)


def sentence(told: ReferenceTold, answers: Sequence[Told]) -> str:
    """What a reference lacks, for people; empty where it lacks nothing."""
    lacks = lacking(told, answers)
    if not lacks:
        return ""
    name = _shortened(list(told.deviations))
    named = [f"{name[each.path]} {_share(each.deviation)} ({_share(each.later)})" for each in lacks[:NAMED]]
    if len(lacks) > NAMED:
        named.append(f"and {len(lacks) - NAMED} others")
    longer = max((each.longer for each in lacks if np.isfinite(each.longer)), default=1.0)
    still = [each for each in lacks if not each.moves or not np.isfinite(each.longer)]
    need = f"Such movements for {_rounded(longer * told.seconds)} s would tell them as surely"
    if len(still) == len(lacks):
        need = "It takes movements as in the later recordings, not only longer ones"
    elif still:
        rest = ", ".join(name[each.path] for each in still[:NAMED])
        need += f", with those of the later recordings for {rest}"
    return (
        f"The reference ({told.seconds:.3g} s) determines these parameters less well than one later recording does. "
        f"Standard deviations from the reference (from one later recording), as shares of the parameter's range: "
        f"{', '.join(named)}. {need}. Changes that this uncertainty could explain count as no evidence, so that small "
        f"faults are seen later."
    )


def _shortened(paths: Sequence[str]) -> dict[str, str]:
    """Full path -> the same without the joint, where there is one alone."""
    joints = {path.split(".")[1] for path in paths if path.startswith("joints.")}
    beginning = f"joints.{next(iter(joints))}." if len(joints) == 1 else ""
    return {path: path.removeprefix(beginning) for path in paths}


def _rounded(seconds: float) -> str:
    """Two digits, as nobody knows it better."""
    return f"{float(f'{seconds:.1e}'):.0f}"


def _share(deviation: float) -> str:
    return f"{100.0 * deviation:.2g} %"
