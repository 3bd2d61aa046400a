"""A law for physics in no list, as a rig file holds it: the terms of `physics.law`, at a joint's stages.

law:
  - enters: cylinder            # the input that it gives, one of `physics.probes.PROBES`
    factors: {place: z, speed: sign(v)}
    seen: rod                   # whose position and speed: rod or joint
    sine: {value: 310.0, unit: N, source: ...}     # its amplitude
    low: {value: 0.0, unit: m, source: ...}        # and what its variables are told in
    ...
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.law import (
    LAW,
    LAW_RECORD,
    MOST_TERMS,
    OTHERS,
    PLACED,
    PLACES,
    SPEEDS,
    TERM_NAMES,
    TIMES,
)
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.rigs.parameters.entries import Entry, parse_entry, written_entry
from hydrolek_drake.rigs.parameters.keys import refuse_unknown

UNITS = {
    "command": "V",
    "amplifier": "1",
    "valve": "1",
    "supply": "Pa",
    "cylinder": "N|N m",
    "load": "N m|N",
    "sensor": "rad|m",
    "capacity_a": "m^3/Pa",
    "capacity_b": "m^3/Pa",
    "back_a": "1",
    "back_b": "1",
    "ramp": "s/V",
    "coil_time": "s",
    "flow_force": "1",
}
"""Inputs that a law may give -> their units; of a vane and of a sliding load the second one."""

FACTORS = {"time": TIMES, "place": PLACES, "speed": SPEEDS, "other": OTHERS}
_SHAPES = {"time": "time", "place": "place", "speed": "speed_shape", "other": "other"}
_SEEN = ("joint", "rod")

SCALES = (
    Parameter("low", "m|rad", "position at which z is -1", 0.0),
    Parameter("high", "m|rad", "position at which z is 1", 1.0),
    Parameter("centre", "m|rad", "position near which the term acts, or from which on", 0.0),
    Parameter(
        "reach",
        "m|rad",
        "so far from it to either side, or so far past it for its amplitude",
        1.0,
        positive=True,
    ),
    Parameter("speed", "m/s|rad/s", "by which v is divided", 1.0, positive=True),
    Parameter("slow", "m/s|rad/s", "below which sign(v) is smoothed", 1.0, positive=True),
    Parameter("seconds", "s", "T in t/T", 1.0, positive=True),
    Parameter("opening", "m", "by which the spool's position is divided", 1.0, positive=True),
    Parameter("pressure", "Pa", "by which pressures are divided", 1.0, positive=True),
)
"""What the variables of a term are told in; it states those of its factors."""

FREQUENCY = Parameter("frequency", "Hz", "of a periodic term", 0.0, lowest=0.0)


def needed(factors: Mapping[str, str]) -> tuple[str, ...]:
    """Names of `SCALES` that the factors of a term need."""
    place, speed, other = (factors.get(name, "1") for name in ("place", "speed", "other"))
    found = {
        "low": place != "1" and place not in PLACED,
        "high": place != "1" and place not in PLACED,
        "centre": place in PLACED,
        "reach": place in PLACED,
        "speed": speed not in ("1", "sign(v)"),
        "slow": speed == "sign(v)",
        "seconds": factors.get("time", "1") != "1",
        "opening": "x" in other,
        "pressure": "p" in other,
    }
    return tuple(name for name, is_needed in found.items() if is_needed)


@dataclass(frozen=True)
class LawTerm:
    """One term of a law.

    Attributes:
        enters: the input that it gives.
        factors: of `FACTORS`, those that are not 1.
        seen: whose position and speed it depends on, rod or joint.
        numbers: amplitudes, frequency and what its variables are told in, by their names in `physics.law.LAW`.
    """

    enters: str
    factors: dict[str, str]
    seen: str
    numbers: dict[str, Entry]

    def record(self) -> np.ndarray:
        """As the physics takes it. # (1,) of `physics.law.LAW`."""
        row = np.zeros(1, LAW)
        row["probe"] = PROBES.index(self.enters)
        for factor, name in self.factors.items():
            row[_SHAPES[factor]] = FACTORS[factor].index(name)
        row["at_rod"] = _SEEN.index(self.seen)
        for p in SCALES:
            row[p.name] = p.neutral
        for name, entry in self.numbers.items():
            row[name] = entry.value
        return row

    def as_tree(self) -> dict[str, Any]:
        """As a rig file holds it."""
        numbers = {name: written_entry(entry) for name, entry in self.numbers.items()}
        return {"enters": self.enters, "factors": dict(self.factors), "seen": self.seen, **numbers}


def terms_of(rows: np.ndarray, units: tuple[str, str], source: str, reach: str) -> tuple[LawTerm, ...]:
    """Terms from rows of `physics.law.LAW`.

    Args:
        rows: shape (k,).
        units: of what the law gives, and of the position that it sees.
        source: where amplitudes and frequency come from.
        reach: where the numbers come from that its variables are told in.
    """
    given, length = units
    moved = dict.fromkeys(("low", "high", "centre", "reach"), length)
    moved |= dict.fromkeys(("speed", "slow"), f"{length}/s")
    told_in = {p.name: moved.get(p.name, p.unit) for p in SCALES}
    terms = []
    for row in rows:
        chosen = {name: FACTORS[name][int(row[_SHAPES[name]])] for name in FACTORS}
        factors = {name: factor for name, factor in chosen.items() if factor != "1"}
        numbers = {"sine": Entry(float(row["sine"]), given, source)}
        if row["frequency"] > 0.0:
            numbers["cosine"] = Entry(float(row["cosine"]), given, source)
            numbers["frequency"] = Entry(float(row["frequency"]), FREQUENCY.unit, source)
        numbers |= {name: Entry(float(row[name]), told_in[name], reach) for name in needed(factors)}
        terms.append(LawTerm(PROBES[int(row["probe"])], factors, _SEEN[int(row["at_rod"])], numbers))
    return tuple(terms)


def read_law(raw: Any, where: str, path: Path) -> tuple[LawTerm, ...]:
    """The law of a joint as a file states it; none where there is none.

    Raises:
        InputError: naming the key, its value and the choices.
    """
    if raw is None:
        return ()
    if not isinstance(raw, list) or not 0 < len(raw) <= MOST_TERMS:
        raise InputError(
            f"{path}: {where} must be a list of 1 to {MOST_TERMS} terms, each {{enters: ..., sine: ...}}"
        )
    return tuple(_read_term(term, f"{where}[{n}]", path) for n, term in enumerate(raw, start=1))


def _read_term(raw: Any, where: str, path: Path) -> LawTerm:
    names = ("enters", "factors", "seen", "sine", "cosine", "frequency", *(p.name for p in SCALES))
    refuse_unknown(raw, names, f"{path}: {where}")
    enters = _choice(raw.get("enters"), tuple(UNITS), f"{path}: {where}.enters")
    factors = raw.get("factors") or {}
    refuse_unknown(factors, tuple(FACTORS), f"{path}: {where}.factors")
    chosen = {
        name: _choice(factor, FACTORS[name], f"{path}: {where}.factors.{name}")
        for name, factor in factors.items()
    }
    seen = _choice(raw.get("seen", "joint"), _SEEN, f"{path}: {where}.seen")
    sizes = (
        Parameter("sine", UNITS[enters], "amplitude, of the sine of a periodic term"),
        Parameter("cosine", UNITS[enters], "amplitude of the cosine of a periodic term", 0.0),
    )
    must = ("sine", *needed(chosen))
    numbers = {}
    for p in (*sizes, FREQUENCY, *SCALES):
        if p.name in raw:
            numbers[p.name] = parse_entry(raw[p.name], p, f"{path}: {where}.{p.name}")
        elif p.name in must:
            raise InputError(f"{path}: {where}.{p.name} is missing: {p.meaning} [{p.unit}]")
    if "low" in must and not numbers["low"].value < numbers["high"].value:
        raise InputError(f"{path}: {where}.low must be smaller than {where}.high")
    return LawTerm(enters, chosen, seen, numbers)


def _choice(given: Any, choices: tuple[str, ...], where: str) -> str:
    if str(given) not in choices:
        said = "is missing" if given is None else f"'{given}' is unknown"
        raise InputError(f"{where} {said}; choose {', '.join(choices)}")
    return str(given)


def law_record(terms: tuple[LawTerm, ...]) -> np.ndarray:
    """A law as a joint's record holds it. # () of `physics.law.LAW_RECORD`."""
    record = np.zeros((), LAW_RECORD)
    for name, term in zip(TERM_NAMES, terms, strict=False):
        record[name] = term.record()[0]
    return record
