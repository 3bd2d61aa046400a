#!/usr/bin/env python3
"""Tables of the thesis's results beside ours, from docs/evidence/data/control.json.

They stand in docs/evidence/thesis_machine.md, and those of Table 6.10, the linear joint 4 and the grasp in
docs/evidence/control.md.

`hydrolek control bench [--plant full] --out DIR` writes the same comparisons as a page; its `bench.json` is what
docs/evidence/data/control.json keeps under "sdp" and "full".
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from hydrolek_drake.control.catalogue import CONTROLLERS
from hydrolek_drake.control.comparison.bench_tables import MEASURES, Measure, beside, text
from hydrolek_drake.control.comparison.thesis_tables import GRASP_TABLES, MACHINE_TABLES, printed

RESULTS = Path(__file__).parents[1] / "docs" / "evidence" / "data" / "control.json"
JOINTS = ("right_j1", "right_j2", "right_j3", "right_j4")
SHOWN = {
    "step": ("rise_s", "overshoot_percent", "switching"),
    "sine": ("mse_deg2", "switching"),
    "grasp": ("rise_s", "overshoot_percent", "switching"),
}
MISPRINTED = {("step", "pip_scaled"), ("grasp", "pi")}
"""Columns that repeat another table's (docs/reference/thesis_errata.md): G.10's scaled PIP, G.6's PI."""

LINEAR = ("pip_idz_a", "pip_idz_b", "pip_idz_c", "pip_forward_a", "pip_forward_b", "pip_forward_c")

ALSO = ("fuzzy_double_printed", "fuzzy_appendix_f")


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def table(trials: list[dict[str, Any]], sequence: str, measure: Measure) -> list[str]:
    """One measure on one sequence as lines of Markdown: ours, and in brackets the machine's."""
    lines = [_row(["controller", *(joint.replace("_", " ") for joint in JOINTS)]), "|---|---|---|---|---|"]
    for name in (*MACHINE_TABLES[sequence], *ALSO):
        trial = next((t for t in trials if (t["controller"], t["sequence"]) == (name, sequence)), None)
        if trial is None:
            continue
        cells = [CONTROLLERS[name][0]]
        for joint in JOINTS:
            value = trial["joints"][joint][measure.key]["value"]
            ours = text(float("nan") if value is None else value, measure.digits)
            cells.append(ours + beside("full", sequence, name, measure, joint))
        lines.append(_row(cells))
    return lines


def wrist_table(trials: list[dict[str, Any]]) -> list[str]:
    """Mean length of the wrist's error on the sine."""
    lines = [_row(["controller", "full plant", "thesis's machine"]), "|---|---|---|"]
    for name in (*MACHINE_TABLES["sine"], *ALSO):
        trial = next((t for t in trials if (t["controller"], t["sequence"]) == (name, "sine")), None)
        if trial is not None:
            theirs = printed("full", "sine", name, "euclidean_mm", "right")
            lines.append(
                _row([CONTROLLERS[name][0], f"{trial['euclidean_mm']['right']:.1f}", text(theirs, 1)])
            )
    return lines


def _of_joint(plant: str, sequence: str, name: str, key: str, joint: str) -> float:
    """What is printed for a joint; joint 4 with the linear model's controller where that alone is."""
    value = printed(plant, sequence, name, key, joint)
    return printed(plant, sequence, name, key, f"{joint}_linear") if np.isnan(value) else value


def nearness(trials: list[dict[str, Any]]) -> list[str]:
    """How near the full plant and the thesis's own SDP models come to its machine: the model-based controllers.

    Rank correlation over controllers and joints, and the median of the ratio of the larger to the smaller value
    (of sizes; of the difference in points for overshoot), where all three have a value.
    """
    lines = [
        _row(["measure", "values", "rank correlation: full plant", "thesis's SDP models",
              "median off: full plant", "thesis's SDP models"]),
        "|---|---|---|---|---|---|",
    ]  # fmt: skip
    by_name = {(trial["controller"], trial["sequence"]): trial for trial in trials}
    for sequence, keys in SHOWN.items():
        for key in keys:
            found = []
            for name in MACHINE_TABLES[sequence]:
                if name.startswith("fuzzy") or (sequence, name) in MISPRINTED:
                    continue
                for joint in JOINTS:
                    own = by_name[name, sequence]["joints"][joint][key]["value"]
                    number = joint.removeprefix("right_")
                    found.append(
                        (
                            _of_joint("full", sequence, name, key, joint),
                            float("nan") if own is None else own,
                            _of_joint("sdp", sequence, name, key, number),
                        )
                    )
            values = np.array(found)
            values = values[np.isfinite(values).all(axis=1)]
            ranks = [spearmanr(values[:, 0], values[:, i]).statistic for i in (1, 2)]
            if key == "overshoot_percent":
                off = [f"{np.median(np.abs(values[:, i] - values[:, 0])):.1f} points" for i in (1, 2)]
            else:
                ratios = np.abs(np.log(values[:, 1:] / values[:, :1]))
                off = [f"factor {np.exp(np.median(ratios[:, i])):.2f}" for i in (0, 1)]
            title = next(measure.title for measure in MEASURES if measure.key == key)
            lines.append(
                _row([f"{sequence}: {title}", str(len(values)), *(f"{rank:.2f}" for rank in ranks), *off])
            )
    return lines


def linear_table(trials: list[dict[str, Any]]) -> list[str]:
    """Joint 4 with the linear SDP law, Tables G.1, G.3 and 6.11: ours, and in brackets the thesis's."""
    shown = [("step", key) for key in ("rise_s", "overshoot_percent", "mse_deg2", "switching")]
    shown += [("sine", key) for key in ("mse_deg2", "voltage_variance", "switching")]
    measures = {measure.key: measure for measure in MEASURES}
    lines = [
        _row(["controller", *(f"{sequence}: {measures[key].title}" for sequence, key in shown)]),
        "|---|---|---|---|---|---|---|---|",
    ]
    for name in LINEAR:
        cells = [CONTROLLERS[name][0]]
        for sequence, key in shown:
            cells.append(_beside_models(trials, sequence, name, measures[key], "j4_linear"))
        lines.append(_row(cells))
    return lines


def model_table(
    trials: list[dict[str, Any]], sequence: str, measure: Measure, joints: tuple[str, ...]
) -> list[str]:
    """One measure on the SDP models, in brackets the thesis's."""
    lines = [
        _row(["controller", *(joint.replace("_", " ") for joint in joints)]),
        "|---" * (len(joints) + 1) + "|",
    ]
    for name in GRASP_TABLES:
        lines.append(
            _row(
                [CONTROLLERS[name][0], *(_beside_models(trials, sequence, name, measure, j) for j in joints)]
            )
        )
    return lines


def _beside_models(
    trials: list[dict[str, Any]], sequence: str, name: str, measure: Measure, joint: str
) -> str:
    trial = next(t for t in trials if (t["controller"], t["sequence"]) == (name, sequence))
    value = trial["joints"][joint][measure.key]["value"]
    ours = text(float("nan") if value is None else value, measure.digits)
    return ours + beside("sdp", sequence, name, measure, joint)


def tables() -> Iterator[tuple[str, str, list[str]]]:
    """Page, title and lines of every table."""
    results = json.loads(RESULTS.read_text(encoding="utf-8"))
    full, models = results["full"]["trials"], results["sdp"]["trials"]
    measures = {measure.key: measure for measure in MEASURES}
    yield "evidence/thesis_machine.md", "how near", nearness(full)
    for sequence, keys in SHOWN.items():
        for key in keys:
            title = f"{sequence}: {measures[key].title}"
            yield "evidence/thesis_machine.md", title, table(full, sequence, measures[key])
    yield "evidence/thesis_machine.md", "sine: mean error of the wrist [mm]", wrist_table(full)
    plain = ("j1", "j2", "j3", "j4")
    yield (
        "evidence/control.md",
        "step: switching (6.10)",
        model_table(models, "step", measures["switching"], plain),
    )
    yield "evidence/control.md", "joint 4 with the linear law", linear_table(models)
    for key in ("rise_s", "overshoot_percent", "mse_deg2", "switching"):
        joints = (*plain, "j4_linear")
        yield (
            "evidence/control.md",
            f"grasp: {measures[key].title}",
            model_table(models, "grasp", measures[key], joints),
        )


if __name__ == "__main__":
    for page, title, lines in tables():
        print(f"{page}, {title}", *lines, "", sep="\n")
