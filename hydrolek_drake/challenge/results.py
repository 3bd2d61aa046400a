"""The files in which a challenge tells its results, and scores of an earlier run read back from them."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hydrolek_drake.challenge.calibration import calibration_png
from hydrolek_drake.challenge.confusion import confusion_markdown
from hydrolek_drake.challenge.scoring import markdown, summaries, summaries_markdown
from hydrolek_drake.challenge.visibility import visibility_markdown
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole


def write_results(out: Path, sha256: str, results: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Write what all scores say, and each of them.

    Args:
        out: folder of `summary.json` and `.md`, `cases.md`, `confusion.md`, `visibility.md` and `calibration.png`.
        sha256: of the labels.
        results: of `scoring.score`.

    Returns:
        What `scoring.summaries` tells.
    """
    told_by = summaries(results)
    contents = {"labels_sha256": sha256, "summary": told_by, "cases": list(results)}
    write_whole(out / "summary.json", json.dumps(contents, indent=1))
    write_whole(out / "summary.md", summaries_markdown(told_by))
    write_whole(out / "cases.md", markdown(results))
    write_whole(out / "confusion.md", confusion_markdown(results))
    write_whole(out / "visibility.md", visibility_markdown(results))
    write_whole(out / "calibration.png", calibration_png(told_by["all"]["calibration"]))
    return told_by


def earlier_scores(path: Path, sha256: str) -> dict[str, dict[str, Any]]:
    """Case -> its score in the `summary.json` of an earlier run.

    Args:
        path: the file.
        sha256: of the labels that it must be about.

    Raises:
        InputError: it cannot be read, is no such file, or is about other cases.
    """
    try:
        contents = json.loads(path.read_text())
        theirs = contents["labels_sha256"]
        scores = {score["name"]: score for score in contents["cases"]}
        summaries(list(scores.values()))  # has all that results are told from
    except OSError as error:
        raise InputError(f"--earlier {path}: cannot be read: {error.strerror or error}") from None
    except (ValueError, KeyError, TypeError):
        raise InputError(f"--earlier {path}: no summary.json of a challenge") from None
    if theirs != sha256:
        raise InputError(
            f"--earlier {path}: scores of cases whose labels have the sha256 {theirs[:12]}..., not {sha256[:12]}...; "
            "the same --rig, --kind, --cases and --seed are needed"
        )
    return scores
