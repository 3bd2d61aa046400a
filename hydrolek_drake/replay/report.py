"""What a replay leaves in its folder: page, picture, numbers and signals."""

import json
import math
from pathlib import Path
from typing import Any

from hydrolek_drake.files import results_folder, write_whole
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.replay.comparison import Comparison
from hydrolek_drake.replay.page import page
from hydrolek_drake.replay.picture import picture
from hydrolek_drake.replay.replay import Replay


def write_report(replay: Replay, comparisons: tuple[Comparison, ...], folder: Path) -> Path:
    """Write `replay.html`, `replay.png`, `replay.json` and `signals.parquet`; each appears when complete.

    Args:
        replay: what was replayed.
        comparisons: of its signals.
        folder: made if it is not there.

    Returns:
        The page's path.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    title = f"{replay.rig.name} driven with {'/'.join(replay.recording.source.parts[-2:])}"
    with results_folder(folder):
        write_signals(folder / "signals.parquet", replay.recording.time, *_signals(replay))
        write_whole(folder / "replay.png", picture(replay, comparisons, title))
        write_whole(folder / "replay.json", json.dumps(as_json(replay, comparisons), indent=1).encode())
        write_whole(folder / "replay.html", page(replay, comparisons, title).encode())
    return folder / "replay.html"


def as_json(replay: Replay, comparisons: tuple[Comparison, ...]) -> dict[str, Any]:
    """The numbers of the report, in SI units; what is not finite is null."""
    return {
        "schema": 1,
        "rig": replay.rig.name,
        "recording": replay.recording.source.name,
        "from_s": float(replay.recording.time[0]),
        "to_s": float(replay.recording.time[-1]),
        "sentence": comparisons[0].sentence() if comparisons else "",
        "notes": list(replay.notes),
        "findings": [finding.message for finding in replay.recording.findings],
        "diverged": {joint: outcome.diverged for joint, outcome in replay.outcomes.items()},
        "signals": [_comparison_json(comparison) for comparison in comparisons],
        "seconds": replay.seconds,
    }


def _comparison_json(c: Comparison) -> dict[str, Any]:
    conditions = {q.name: {"of_error": q.of_error, "of_time": q.of_time} for q in c.conditions}
    for q in c.growing:
        conditions[q.name]["of_growth"] = q.of_error
    return {
        "signal": c.key,
        "unit": c.unit,
        "samples": c.samples,
        "rms": _finite(c.rms),
        "mean": _finite(c.mean),
        "largest": _finite(c.largest),
        "largest_at_s": _finite(c.largest_at),
        "noise": c.noise,
        "rms_over_noise": _finite(c.rms_over_noise),
        "agrees": c.agrees,
        "sentence": c.sentence(),
        "worst_spans": [
            {"from_s": s.start, "to_s": s.end, "share_of_error": s.share, "largest": s.largest}
            for s in c.spans
        ],
        "conditions": conditions,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _signals(replay: Replay) -> tuple[dict[str, Any], dict[str, str]]:
    signals, units = {}, {}
    for joint, command in replay.commands.items():
        signals[f"{joint}.command"] = command
        units[f"{joint}.command"] = "V"
    for pair in replay.pairs:
        for name, values in (("measured", pair.measured), ("model", pair.model), ("residual", pair.residual)):
            signals[f"{pair.key}_{name}"] = values
            units[f"{pair.key}_{name}"] = pair.unit
    return signals, units
