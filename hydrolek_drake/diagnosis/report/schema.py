"""The JSON schema of `report.json`: what programs that read it may rely on."""

from typing import Any

STAGES = (
    "command",
    "amplifier",
    "solenoid",
    "valve",
    "supply",
    "fluid",
    "cylinder",
    "linkage",
    "load",
    "base",
    "sensor",
)
"""Where a mismatch may enter, in the order from command to reading."""

VERDICTS = {
    "none": "the nominal model explains the data",
    "missing_physics": "the effects that are named do, beside it",
    "ambiguous": "several structures do, which these data do not tell apart",
    "unlisted_physics": "something is missing that is in no list; a law found for it is among the effects",
    "interrupted": "the search was ended by an interrupt or by --at-most; what is told is what was known by then",
    "bad_data": "the recordings cannot be diagnosed; the reasons say why",
}


def report_schema() -> dict[str, Any]:
    """The schema (draft 2020-12). Keys may be added; those that are here stay."""
    numbers = {"train_rms": "fitted", "holdout_rms": "held out"}
    errors = _object(
        {
            **{
                key: _number(f"root mean square of the position, {what}, in `unit`")
                for key, what in numbers.items()
            },
            "train_over_noise": _number("root mean square of all signals over their noise, fitted"),
            "holdout_over_noise": _number("the same, held out"),
        },
        "one model's errors",
    )
    size = _object(
        {
            "value": _number("most probable value, in the unit at the end of the parameter's name"),
            "low": _number("lower end of the 95 % interval"),
            "high": _number("upper end of the 95 % interval"),
        },
        "one number of an effect",
        required=("value",),
        open_=True,
    )
    effect = _object(
        {
            "id": _text("id of the effect, or `unlisted.STAGE` for a law in no list"),
            "joint": _text("joint at which it acts"),
            "probability": _number(
                "how probable it is that the name is right, calibrated on concealed machines"
            ),
            "parameters": {
                "type": "object",
                "description": "parameter -> value with interval",
                "additionalProperties": size,
            },
            "sentence": _text("one plain sentence; for a law its equation"),
        },
        "one thing that was added to the model",
        open_=True,
    )
    place = _object(
        {
            "stage": {"enum": list(STAGES), "description": "stage at which the mismatch enters"},
            "joint": _text("joint"),
            "share_of_mismatch": _number("share of the squared error that it explains"),
            "when": {
                "type": "array",
                "description": "intervals in which it grows [s]",
                "items": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
            },
            "condition": _text("what the machine does there", null=True),
        },
        "one place",
    )
    candidate = _object(
        {
            "effects": _texts("ids of what was added"),
            "probability": _number("posterior among the structures that were tried"),
            "train_over_noise": _number("fitted, times the noise"),
            "holdout_over_noise": _number("held out, times the noise"),
            "behind": _number("log-density of the held-out data less that of the best structure", null=True),
            "behind_standard_error": _number("standard error of that", null=True),
            "given_up": {"const": True, "description": "the structure was not fitted to its end"},
        },
        "one structure that was tried",
        required=("effects", "probability", "train_over_noise", "holdout_over_noise"),
    )
    fit = _object(
        {
            "noise_floor": _number("standard deviation of the position's noise, in `unit`"),
            "unit": _text("of the root mean squares"),
            "baseline": {**errors, "description": "the nominal model, its own numbers fitted"},
            "with_effects": {**errors, "description": "with everything that was added"},
            "without_law": {
                **errors,
                "description": "with the effects that are named, where a law stands beside them",
            },
        },
        "errors before and after; improvement counts over the refitted nominal model",
        required=("noise_floor", "unit", "baseline", "with_effects"),
    )
    whole = _object(
        {
            "schema": {"const": 1, "description": "version of this schema"},
            "verdict": {
                "enum": list(VERDICTS),
                "description": "; ".join(f"`{k}`: {v}" for k, v in VERDICTS.items()),
            },
            "sentence": _text("the verdict in words"),
            "locations": {
                "type": "array",
                "items": place,
                "description": "where and when the mismatch enters",
            },
            "effects": {
                "type": "array",
                "items": effect,
                "description": "what was added to the model, the most probable first",
            },
            "not_zero": _texts("effects which the rig has already and whose size is not zero, in words"),
            "not_distinguishable": {
                "type": "array",
                "items": _texts("ids"),
                "description": "groups that these data do not tell apart",
            },
            "next_experiment": _text("which recording or sensor would decide", null=True),
            "detectable_from": {
                "type": "object",
                "additionalProperties": {"type": "string"},
                "description": "effect that was not found -> smallest size that these data would have shown",
            },
            "fit": {**fit, "type": ["object", "null"]},
            "candidates": {
                "type": "array",
                "items": candidate,
                "description": "structures that were compared on the held-out data",
            },
            "reasons": _texts("remarks on data and verdict"),
            "seconds": _number("duration [s]"),
            "diagram": {
                "type": "array",
                "items": _object(
                    {},
                    "one signal of one recording: how far Diagram, rollout and recording are apart",
                    open_=True,
                ),
                "description": "the fitted rig through its Drake diagram; empty with --no-confirm",
            },
        },
        "what `hydrolek diagnose` found",
    )
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "report.json of hydrolek diagnose",
        **whole,
    }


def _object(
    properties: dict[str, Any], what: str, required: tuple[str, ...] | None = None, open_: bool = False
) -> dict[str, Any]:
    return {
        "type": "object",
        "description": what,
        "properties": properties,
        "required": list(properties if required is None else required),
        "additionalProperties": open_,
    }


def _number(what: str, null: bool = False) -> dict[str, Any]:
    return {"type": ["number", "null"] if null else "number", "description": what}


def _text(what: str, null: bool = False) -> dict[str, Any]:
    return {"type": ["string", "null"] if null else "string", "description": what}


def _texts(what: str) -> dict[str, Any]:
    return {"type": "array", "items": {"type": "string"}, "description": what}
