"""What a fit says and writes."""

import json
from collections.abc import Sequence
from pathlib import Path

import yaml

from hydrolek_drake.files import write_results
from hydrolek_drake.identification.fit.fitting import RigFit
from hydrolek_drake.replay.confirmation import Confirmation

AT_NOISE = 1.05
"""Rms over noise up to which a fit counts as having reached it."""


AT_END = 1e-3
"""Part of the range from its end within which a parameter counts as having run into it."""


def sentences(fitted: RigFit) -> list[str]:
    """How well it follows, and what the recordings cannot tell."""
    lines = [f"{fitted.method}, {fitted.evaluations} evaluations: {_judged(fitted.over_noise)}"]
    if fitted.holdout_over_noise is not None:
        lines.append(f"held-out recordings: {_judged(fitted.holdout_over_noise)}")
    for free, u in zip(fitted.parameters.free, fitted.unit, strict=True):
        if min(u, 1.0 - u) < AT_END:
            which = "lower" if u < 0.5 else "upper"
            lines.append(
                f"{free.path} ended at the {which} end of its range: widen the range, or doubt the model"
            )
    for one, other, correlation in fitted.known.confused[:5]:
        lines.append(f"{one} and {other} cannot be told apart here (correlation {correlation:+.3f})")
    for direction in fitted.known.blurred():
        mixed = ", ".join(f"{share:+.2f} {path}" for path, share in direction.items())
        lines.append(f"not determined within its range: {mixed}")
    if fitted.interrupted:
        onward = (
            "least squares keeps no checkpoint and would start anew"
            if fitted.search is None
            else "the same command with --out goes on"
        )
        lines.append(f"interrupted: the best so far is given; {onward}")
    return lines


def _judged(over_noise: float) -> str:
    if over_noise <= AT_NOISE:
        return f"the model reaches the noise (residuals {over_noise:.3f} times it)"
    return f"the residuals are {over_noise:.3g} times the noise, so the model misses something"


def write_fit(fitted: RigFit, folder: Path, confirmed: Sequence[Confirmation] = ()) -> list[Path]:
    """Write `rig_fitted.yaml` and `fit.json`, each when complete.

    Args:
        fitted: what was found.
        folder: where; made if it is missing.
        confirmed: the same on the Drake Diagram, where that was run.
    """
    rows = fitted.intervals()
    content = {
        "method": fitted.method,
        "evaluations": fitted.evaluations,
        "interrupted": fitted.interrupted,
        "over_noise": fitted.over_noise,
        "holdout_over_noise": fitted.holdout_over_noise,
        "parameters": {
            path: {"value": value, "low": low, "high": high} for path, (value, low, high) in rows.items()
        },
        "confused": [list(pair) for pair in fitted.known.confused],
        "not_determined": list(fitted.known.blurred()),
        "diagram": [each.as_json() for each in confirmed],
    }
    texts = {
        "rig_fitted.yaml": yaml.safe_dump(fitted.rig.as_tree(), sort_keys=False, allow_unicode=True),
        "fit.json": json.dumps(content, indent=1) + "\n",
    }
    return write_results(folder, texts)
