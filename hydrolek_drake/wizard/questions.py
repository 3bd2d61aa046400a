"""What is asked of a data sheet, and the answers in SI."""

import difflib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.units import si_factor
from hydrolek_drake.yaml_files import package_yaml

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?!/)"  # the 1 of 1/s belongs to the unit
_SPLIT = re.compile(rf"\s*(?P<numbers>{_NUMBER}(?:[,;\s]+{_NUMBER})*)\s*(?P<unit>1/.*|[^\d\s,;.+-].*)?")
SIGNED = (
    "base_mount", "link_mount", "centre", "mid_stroke_at", "link_travel", "overlap", "pushed_by", "current_at_rest",
    "neutral_command",
)  # fmt: skip
MAY_BE_ZERO = (
    "rod", "delay", "tank_pressure", "pump_leakage", "relief_hysteresis", "port_shares", "rated_flow", "angle_noise",
    "position_noise", "pressure_noise", "bearing_damping", "guide_damping", "seal_damping",
    "model_error", "position_time", "speed_time", "top_speed", "current_noise",
)  # fmt: skip
"""Questions whose answers may be below zero, and zero."""

SMALLEST, LARGEST = 1e-15, 1e15
"""In SI; beyond, nothing can be calculated with an answer."""

SI = {
    "mm": "m", "m": "m", "cm^3": "m^3", "l": "m^3", "deg": "rad", "kg": "kg", "N m s/rad": "N m s/rad",
    "N s/m": "N s/m", "ms": "s", "V": "V", "Hz": "rad/s", "1": "1", "l/min": "m^3/s", "bar": "Pa", "kPa": "Pa",
    "GPa": "Pa", "cm^3/rev": "m^3/rad", "rpm": "rad/s", "kg/m^3": "kg/m^3", "mm/V": "m/V", "mm/s": "m/s",
    "1/s": "1/s", "A": "A", "N": "N", "N m/A": "N m/A", "%": "1", "N m": "N m", "kg cm^2": "kg m^2",
}  # fmt: skip
"""Unit of a question -> SI unit of its answer."""


SCREW = "screw"
"""What `moves` says of a machine without oil."""


class Share(float):
    """An answer in % of another one."""


@dataclass(frozen=True)
class Question:
    """One line of a data sheet.

    Attributes:
        key: name of its option and of its answer.
        asks: what it is.
        unit: that is meant where an answer has none; empty for words.
        numbers: how many numbers an answer may have.
        choices: words that an answer may be; any if empty.
        what: the rest of its entry in `questions.yaml`.
    """

    key: str
    asks: str
    unit: str
    numbers: tuple[int, ...]
    choices: tuple[str, ...]
    what: Mapping[str, Any]

    @property
    def option(self) -> str:
        """As it stands on the command line."""
        return "--" + self.key.replace("_", "-")

    @property
    def needed(self) -> bool:
        """Whether nothing can be assumed."""
        known = ("assume", "assume_share", "text", "optional")
        return not any(name in self.what for name in known)

    def applies(self, answers: Mapping[str, Any]) -> bool:
        """Whether it is asked of a machine with these answers."""
        wanted = self.what.get("for")
        if answers.get("moves") == SCREW:
            return wanted == SCREW or self.key in _tree()["_screw"]
        holding = answers.get("holding", "none")
        if wanted == "holding":
            return bool(holding != "none")
        return wanted is None or wanted in (answers.get("moves"), answers.get("supply"), holding)


@cache
def questions() -> dict[str, Question]:
    """All questions, in the order in which they are asked."""
    found = {}
    for key, what in _tree().items():
        if not key.startswith("_"):
            count = what.get("numbers", 1)
            numbers = tuple(count) if isinstance(count, list) else (count,)
            choices = tuple(what.get("choices", ()))
            found[key] = Question(key, what["asks"], what.get("unit", ""), numbers, choices, what)
    return found


def fixed(name: str) -> Mapping[str, Any]:
    """A number that no data sheet has: value, unit, source."""
    entry: Mapping[str, Any] = _tree()["_fixed"][name]
    return entry


@cache
def _tree() -> dict[str, Any]:
    tree: dict[str, Any] = package_yaml("hydrolek_drake.wizard", "questions.yaml")
    return tree


def answer(question: Question, text: str) -> Any:
    """An answer in SI: a word, a number, or a tuple of numbers; a `Share` in %.

    Raises:
        InputError: it is none of the choices, no number, of another kind of unit, or not as many numbers.
    """
    where = f"{question.option} '{text}'"
    if not question.unit:
        if question.choices and text not in question.choices:
            raise InputError(f"{where}: unknown; choose {' or '.join(question.choices)}")
        return text
    found = _SPLIT.fullmatch(text)
    numbers = [float(part) for part in re.split(r"[,;\s]+", found["numbers"])] if found else []
    if not numbers or not all(map(math.isfinite, numbers)):
        raise InputError(f"{where}: not a number with a unit, such as '{_example(question)}'")
    if len(numbers) not in question.numbers:
        wanted = " or ".join(map(str, question.numbers))
        raise InputError(f"{where}: {len(numbers)} numbers, where {wanted} belong: {question.asks}")
    unit = (found["unit"] or "").strip() if found else ""
    if question.key == "lead":
        unit = unit.removesuffix("/rev")  # a lead is a way a turn
    if unit == "%" and "percent_of" in question.what:
        return Share(numbers[0] / 100.0)
    try:
        factor = _factor(unit or question.unit, SI[question.unit])
    except InputError as error:
        raise InputError(f"{where}: {error}; such as '{_example(question)}'") from None
    values = tuple(number * factor for number in numbers)
    for value in values:
        if abs(value) > LARGEST or 0.0 < abs(value) < SMALLEST:
            raise InputError(f"{where}: no machine has that")
        if value < 0.0 and question.key not in SIGNED:
            raise InputError(f"{where}: must not be below zero")
        if value == 0.0 and question.key not in (*SIGNED, *MAY_BE_ZERO):
            raise InputError(f"{where}: must be above zero")
    return values if question.numbers != (1,) else values[0]


def _factor(unit: str, si: str) -> float:
    if si == "rad/s" and unit.endswith("Hz"):
        return 2.0 * math.pi * si_factor(unit, "Hz")  # cycles a second
    return si_factor(unit, si)


def _example(question: Question) -> str:
    number = {1: "40", 2: "0.1, -0.3", 4: "1, 1, 0.8, 0.8"}[question.numbers[-1]]
    return number if question.unit == "1" else f"{number} {question.unit}"


def read_answers(given: Mapping[str, str]) -> dict[str, Any]:
    """Answers in SI of those questions that were answered.

    Args:
        given: key or option -> text.

    Raises:
        InputError: a question that is not asked, or an answer that is none.
    """
    known = questions()
    answers: dict[str, Any] = {}
    for name, text in given.items():
        key = name.lstrip("-").replace("-", "_")
        if key not in known:
            near = difflib.get_close_matches(key, known, n=2)
            hint = f"; did you mean {' or '.join(known[n].option for n in near)}?" if near else ""
            raise InputError(f"rig new: no question '--{key.replace('_', '-')}'{hint} --questions lists all")
        answers[key] = answer(known[key], text)
    return answers


def missing(answers: Mapping[str, Any]) -> list[Question]:
    """Questions without which no rig can be written."""
    left = [q for q in questions().values() if q.needed and q.key not in answers and q.applies(answers)]
    if answers.get("moves") == SCREW:
        return left
    by_width = "spool_diameter" in answers and "port_shares" in answers
    by_flow = "rated_flow" in answers and "rated_drop" in answers
    for one, other in (("rated_flow", "rated_drop"), ("rated_drop", "rated_flow")):
        if one in answers and other not in answers:
            return [*left, questions()[other]]
    if not by_width and not by_flow:
        names = ("spool_diameter", "port_shares")
        if "spool_diameter" not in answers and "port_shares" not in answers:
            names = ("rated_flow", "rated_drop")
        left += [questions()[name] for name in names if name not in answers]
    return left
