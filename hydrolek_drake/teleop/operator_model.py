"""How long people take: keystroke-level model, Hick's law and the model human processor (Card, Moran, Newell 1983)."""

import math
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.yaml_files import package_yaml


@cache
def _data() -> dict[str, Any]:
    return package_yaml(__package__, "operator.yaml")


@cache
def operator_entries(part: str) -> MappingProxyType[str, float]:
    """Name -> value of `human` or `hand` of `operator.yaml`."""
    return MappingProxyType({name: float(entry["value"]) for name, entry in _data()[part].items()})


@dataclass(frozen=True)
class Operator:
    """What tells operators apart.

    Attributes:
        name: `inexperienced` or `experienced`.
        mental_acts: Mental acts before an action.
        press: Finding and pressing a control in s.
        knows_dead_time: Whether a stick is let go a dead time early.
        most_deflection: Of the stick in percent.
        pace: Factor of all the operator's times.
    """

    name: str
    mental_acts: int
    press: float
    knows_dead_time: bool
    most_deflection: float
    pace: float = 1.0


def make_operator(name: str, generator: np.random.Generator | None = None) -> Operator:
    """An operator of `operator.yaml`, with a pace drawn log-normally about 1, or 1 without a generator.

    Raises:
        InputError: Unknown name.
    """
    known = _data()["operators"]
    if name not in known:
        raise InputError(f"operator '{name}' is unknown; choose {', '.join(known)}")
    values = {key: entry["value"] for key, entry in known[name].items()}
    scatter = operator_entries("human")["pace_scatter"]
    pace = 1.0 if generator is None else float(np.exp(scatter * generator.standard_normal()))
    return Operator(
        name,
        int(values["mental_acts"]),
        float(values["press"]),
        bool(values["knows_dead_time"]),
        float(values["most_deflection"]),
        pace,
    )


def reaction_time() -> float:
    """See, decide, act: one cycle of each processor, in s."""
    human = operator_entries("human")
    return human["perceptual_cycle"] + human["cognitive_cycle"] + human["motor_cycle"]


def choice_time(alternatives: int) -> float:
    """Choosing one of equally likely alternatives, in s: Hick's law, b log2(n + 1); Card, Moran, Newell 1983."""
    return operator_entries("human")["time_per_bit"] * math.log2(alternatives + 1)


def preparation(operator: Operator, alternatives: int) -> float:
    """From one control of a joint to another, in s: think, choose, move the hand there, press.

    Args:
        operator: Who does it.
        alternatives: Joints and directions there are to choose from.
    """
    human = operator_entries("human")
    thinking = operator.mental_acts * human["mental_act"] + choice_time(alternatives)
    return operator.pace * (thinking + human["homing"] + operator.press)


def clicking(operator: Operator, clicks: int) -> float:
    """Clicks on the console in s, each with its mental acts: what to click, and for a beginner also what is next.

    Args:
        operator: Who does it.
        clicks: Buttons and points in the pictures, one after the other.
    """
    human = operator_entries("human")
    one = operator.mental_acts * human["mental_act"] + human["pointing"] + human["click"]
    return operator.pace * clicks * one
