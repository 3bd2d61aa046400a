"""The study's results as tables beside the thesis's, learning curves, and JSON."""

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.files import write_results
from hydrolek_drake.identification.mechanical.mechanical_model import mechanical_parameters
from hydrolek_drake.identification.mechanical.study import Run, study_data
from hydrolek_drake.identification.search.genetic.settings import SIMPLE

CURVES = {
    "learning_fitness": ("(4.13) p = inf", "(4.13) p = 1", "(4.13) p = 2", "(4.14) p = inf"),
    "learning_crossover": ("crossover 0.6", "(4.13) p = inf", "crossover 1.0"),
    "learning_coding": ("(4.13) p = inf", "integer coding"),
}
"""Picture -> rows, like figures 4.13 to 4.15."""

LABELS = {
    "learning_crossover": {"(4.13) p = inf": "crossover 0.8"},
    "learning_coding": {"(4.13) p = inf": "binary"},
}


def as_json(found: dict[str, list[Run]], seed: int, date: str, seconds: float) -> dict[str, Any]:
    """Everything but the learning curves."""
    return {
        "date": date,
        "seed": seed,
        "seconds": round(seconds, 1),
        "parameters": mechanical_parameters().names,
        **{
            name: [
                {
                    "row": run.row,
                    "method": run.method,
                    "budget": run.budget,
                    "estimate": run.estimate.tolist(),
                    "sum_of_relative_errors": float(run.relative_errors.sum()),
                    "output_error_deg": run.output_error,
                    "mean_squared_error_deg2": run.mean_squared_error,
                }
                for run in runs
            ]
            for name, runs in found.items()
        },
    }


def as_markdown(found: dict[str, list[Run]]) -> str:
    """Tables like 4.2, 4.3, 4.5, 4.6 and 4.7, the thesis's number in brackets, and methods at equal budgets."""
    thesis = study_data()["thesis"]
    lines = [
        "## Simple search (Tables 4.2, 4.3)",
        "",
        *_table(found["sweep"], "ga", thesis),
        "",
        "## Multi-objective search (Tables 4.5, 4.6, 4.7)",
        "",
        *_table(found["sweep"], "nsga2", thesis),
        "",
        "## Methods at equal budgets",
        "",
        "| method | evaluations | sum of relative errors: median (best, worst) | largest error [deg] "
        "| mean squared error [deg²] |",
        "|---|---|---|---|---|",
    ]
    for name, label in (("comparison", ""), ("noisy", ", noise 0.05 deg on the data")):
        for row, budget in dict.fromkeys((run.row, run.budget) for run in found[name]):
            runs = [run for run in found[name] if (run.row, run.budget) == (row, budget)]
            lines.append(
                f"| {row}{label} | {budget} | {_sums(runs)} | {_median(runs, 'output_error')} | "
                f"{_median(runs, 'mean_squared_error')} |"
            )
    return "\n".join(lines) + "\n"


def _table(runs: Sequence[Run], method: str, thesis: dict[str, Any]) -> list[str]:
    names = mechanical_parameters().names
    lines = [
        "| row | "
        + " | ".join(names)
        + " | sum: median (best, worst) [thesis] | largest error [deg] [thesis] "
        "| mean squared error [deg²] [thesis] |",
        "|" + "---|" * (len(names) + 4),
    ]
    for row in dict.fromkeys(run.row for run in runs if run.method == method):
        own = [run for run in runs if run.row == row]
        medians = np.median([run.relative_errors for run in own], axis=0)
        printed = thesis["relative_errors"].get(row)
        lines.append(
            f"| {row} | "
            + " | ".join(f"{value:.2f}" for value in medians)
            + f" | {_sums(own)}{_thesis(sum(printed) if printed else None)} "
            f"| {_median(own, 'output_error')}{_thesis(thesis['output_error_index'].get(row))} "
            f"| {_median(own, 'mean_squared_error')}{_thesis(thesis['mean_squared_error'].get(row))} |"
        )
    return lines


def _thesis(value: float | None) -> str:
    return "" if value is None else f" [{value:.4g}]"


def _sums(runs: Sequence[Run]) -> str:
    sums = [float(run.relative_errors.sum()) for run in runs]
    return f"{np.median(sums):.3g} ({min(sums):.3g}, {max(sums):.3g})"


def _median(runs: Sequence[Run], attribute: str) -> str:
    return f"{np.median([getattr(run, attribute) for run in runs]):.3g}"


def learning_picture(runs: Sequence[Run], name: str) -> bytes:
    """Learning curves of each row: geometric mean of the runs, each over its best of the first population."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    axis = figure.subplots()
    for row in CURVES[name]:
        own = [run.learning for run in runs if run.row == row]
        shortest = min(map(len, own))
        curves = np.array([curve[:shortest] / curve[min(SIMPLE.population, shortest) - 1] for curve in own])
        mean = np.exp(np.log(np.maximum(curves, np.finfo(float).tiny)).mean(axis=0))
        axis.semilogy(np.arange(1, shortest + 1), mean, label=LABELS.get(name, {}).get(row, row))
    axis.set_xlabel("evaluations")
    axis.set_ylabel("least objective over that of the first population")
    axis.set_title(f"geometric mean of {len(own)} runs", fontsize=9)
    axis.set_ylim(None, 3.0)
    axis.grid(alpha=0.25)
    axis.legend()
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=110)
    return data.getvalue()


def write_study(
    found: dict[str, list[Run]],
    folder: Path,
    data: Path,
    pictures: Path,
    seed: int,
    date: str,
    seconds: float,
) -> list[Path]:
    """Write tables to one folder, JSON and pictures to others; each under a temporary name first."""
    numbers = {
        "genetic_study.json": (json.dumps(as_json(found, seed, date, seconds), indent=1) + "\n").encode()
    }
    tables = {
        "genetic_study_tables.md": (
            f"# Results of scripts/genetic_study.py, {date}, seed {seed}, {seconds / 60.0:.0f} min\n\n"
            + as_markdown(found)
        ).encode(),
    }
    drawn = {f"{name}.png": learning_picture(found["sweep"], name) for name in CURVES}
    return write_results(data, numbers) + write_results(folder, tables) + write_results(pictures, drawn)
