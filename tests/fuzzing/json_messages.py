"""What a browser says to the console, in JSON, and pieces that are no good JSON or that nobody meant."""

import json
from typing import Any

import numpy as np

from hydrolek_drake.workcell.scene import home_posture

GOOD_MESSAGES: tuple[dict[str, Any], ...] = (
    {"do": "here"}, {"do": "stop"}, {"do": "token", "token": "x" * 24},
    {"do": "joystick", "deflection": [40.0] + [0.0] * 13},
    {"do": "sliders_to", "angles_deg": np.degrees(home_posture()).round(2).tolist()}, {"do": "let_go"},
    {"do": "back"}, {"do": "resume"}, {"do": "abort"}, {"do": "confirm"}, {"do": "release"},
    {"do": "click", "u": 100.5, "v": 200}, {"do": "sliders", "low_contrast": 0.3, "sensitivity": None},
    {"do": "fill", "name": "edges"}, {"do": "task", "name": "place"}, {"do": "timer", "action": "start"},
    {"do": "timer", "action": "stop"},
    {
        "do": "ratings", "operator": "=1+1", "control": "assisted", "note": "", "mental": 1, "physical": 2.0,
        "temporal": 3, "performance": 4, "effort": 5, "frustration": 6,
    },
)  # fmt: skip
JSON_PIECES = (list(GOOD_MESSAGES), {"a": [1, [2, [3]]], "b": {"c": None}})
JSON_RAW = (
    "9" * 350, "-" + "9" * 350, "1e999", "-1e999", "NaN", "Infinity", "-Infinity", '"\\u0000"', '"\\ud800"',
    '"\\ud83d\\ude00"', "[" * 1500 + "]" * 1500, '{"a":' * 500 + "1" + "}" * 500, '{"do":"stop","do":"here"}',
    "01", "1.", ".5", "'x'", "tru", '"\\x"', '"', "[1,]", "{,}", "undefined", "// x", "1e-400",
    "0." + "3" * 400, '"' + "x" * 3000 + '"', "\ufeff", "\x00", "{}",
)  # fmt: skip


def as_json(tree: Any, raw: list[str]) -> str:
    """A tree as text, with raw text where `tree_damage` has left a place for it."""
    text = json.dumps(tree)
    for number, each in enumerate(raw):
        text = text.replace(f'"rawtext{number}rawtext"', each)
    return text
