"""The JSON schema of rig files, from what stages and effects declare."""

from collections.abc import Iterable
from typing import Any

from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.records import JOINT_STAGES, SHARED_STAGES
from hydrolek_drake.rigs.parameters.declarations import OF_INTEGRATION
from hydrolek_drake.rigs.reading.parts import USES

_TEXT = {"type": "string"}
_NUMBER = {"type": ["number", "string"]}
_ENTRY_KEYS: dict[str, Any] = {
    "value": _NUMBER,
    "unit": {"type": ["string", "integer"]},
    "source": _TEXT,
    "range": {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2},
    "scale": {"enum": ["linear", "log"]},
    "note": _TEXT,
}


def rig_schema() -> dict[str, Any]:
    """The schema (draft 2020-12): keys, units and meanings for completion; values are checked when a rig is loaded.

    A rig that is based on another one states only what differs, so nothing but the joints' kind of content is required.
    """
    joint = {
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "like": {
                "type": "string",
                "description": "joint of this file whose stages it has but for what follows",
            },
            **{name: _stage(stage) for name, stage in JOINT_STAGES.items()},
            "effects": _effects(),
            "law": {"type": "array", "description": "terms of a law for physics in no list"},
        },
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "hydrolek rig",
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "schema": {"const": 1},
            "name": _TEXT,
            "title": _TEXT,
            "source": _TEXT,
            "based_on": {"type": "string", "description": "built-in rig, or file beside this one"},
            "keep": {"type": "array", "items": _TEXT, "description": "joints that move; the others are held"},
            **{name: _stage(stage) for name, stage in SHARED_STAGES.items()},
            "effects": _effects(),
            "joints": {"type": "object", "additionalProperties": joint},
            "recording": {
                "type": "object",
                "additionalProperties": False,
                "properties": {
                    "columns": {"type": "object", "additionalProperties": _TEXT},
                    "initial_position": {"enum": ["rig", "recording"]},
                    "driven_by": {
                        "type": "array",
                        "items": _TEXT,
                        "description": "recorded signals that drive the model in place of a part of it",
                    },
                },
            },
            "integration": _parameters(OF_INTEGRATION),
        },
    }


def _stage(stage: Stage) -> dict[str, Any]:
    """All parameters of any variant; those of one variant alone where it is named."""
    every = {p.name: p for variant in stage.variants for p in stage.parameters(variant)}
    also = {
        "variant": {"enum": list(stage.variants)},
        USES: {"type": "string", "description": "file of a part"},
    }
    found = _parameters(every.values(), also=also)
    found["description"] = stage.meaning
    found["allOf"] = [
        {
            "if": {"properties": {"variant": {"const": name}}, "required": ["variant"]},
            "then": {"propertyNames": {"enum": ["variant", USES, *(p.name for p in stage.parameters(name))]}},
        }
        for name in stage.variants
    ]
    found["type"] = ["object", "null"]
    return found


def _effects() -> dict[str, Any]:
    return {
        "type": "object",
        "additionalProperties": False,
        "properties": {
            effect.id: {**_parameters(effect.parameters), "description": effect.title}
            for effect in EFFECTS.values()
        },
    }


def _parameters(parameters: Iterable[Parameter], also: dict[str, Any] | None = None) -> dict[str, Any]:
    return {
        "type": "object",
        "additionalProperties": False,
        "properties": {**(also or {}), **{p.name: _entry(p) for p in parameters}},
    }


def _entry(parameter: Parameter) -> dict[str, Any]:
    return {
        "description": f"{parameter.meaning} [{parameter.unit}]",
        "type": "object",
        "additionalProperties": False,
        "properties": {**_ENTRY_KEYS, "same_as": _TEXT},
        "anyOf": [{"required": ["value", "unit"]}, {"required": ["same_as"]}],
    }
