"""What `hydrolek sensitivity` writes: ranking as JSON, and pictures like figures 4.7 and B.1 to B.9."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.files import write_results
from hydrolek_drake.identification.sensitivity.sobol import SobolIndices
from hydrolek_drake.identification.sensitivity.study import SensitivityStudy

LEAST = 1e-4
"""Part of the largest effect below which a parameter has none."""

SHOWN = 16
"""Parameters whose outputs are drawn: as many as the thesis searched (Table 4.1)."""


def short(path: str, joint: str) -> str:
    """A path without the joint, for pictures and tables."""
    return path.removeprefix(f"joints.{joint}.")


def as_json(study: SensitivityStudy) -> dict[str, Any]:
    """Ranking, values per segment, what cannot be told apart, and what was left out."""
    return {
        "joint": study.joint,
        "unit": study.response.unit,
        "segments": study.response.segments,
        "parameters": [
            {
                "path": study.paths[i],
                "range": [study.varied.free[i].lower, study.varied.free[i].upper],
                "mean_size_per_segment": study.effects.mean_size[i].tolist(),
                "deviation_per_segment": study.effects.deviation[i].tolist(),
                "one_at_a_time_per_segment": study.one_at_a_time.spread[i].tolist(),
                **_sobol_row(study, int(i)),
            }
            for i in study.ranking
        ],
        "confused": [list(pair) for pair in study.known.confused],
        "not_determined": list(study.known.blurred()),
        "singular_values": study.known.singular_values.tolist(),
        "left_out": study.varied.left_out,
    }


def _sobol_row(study: SensitivityStudy, i: int) -> dict[str, Any]:
    """Sobol indices of one parameter; nothing where none were asked for."""
    found = study.sobol
    if found is None:
        return {}
    return {
        "sobol": {
            "first": float(found.first_whole[i]),
            "total": float(found.total_whole[i]),
            "total_95_percent": [float(found.total_low[i]), float(found.total_high[i])],
            "first_per_segment": found.first[i].tolist(),
            "total_per_segment": found.total[i].tolist(),
        }
    }


def write_study(study: SensitivityStudy, folder: Path) -> list[Path]:
    """Write JSON and pictures, each when complete; returns the paths."""
    contents = {
        f"sensitivity_{study.joint}.json": (json.dumps(as_json(study), indent=1) + "\n").encode(),
        f"sensitivity_{study.joint}.png": ranking_picture(study),
        f"sensitivity_{study.joint}_outputs.png": outputs_picture(study),
    }
    if study.sobol is not None:
        contents[f"sensitivity_{study.joint}_sobol.png"] = sobol_picture(study, study.sobol)
    return write_results(folder, contents)


def ranking_picture(study: SensitivityStudy) -> bytes:
    """mu* per segment of every parameter, the one that matters most on top, and mu* against sigma."""
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    whole = np.sqrt((study.effects.mean_size**2).mean(axis=1))
    order = np.array([i for i in study.ranking if whole[i] > LEAST * whole.max()])
    sizes = study.effects.mean_size[order]
    figure = Figure(figsize=(11.0, 1.5 + 0.17 * len(order)), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1.2, 1.0])
    largest = float(sizes.max())
    image = left.imshow(
        np.maximum(sizes, LEAST * largest),
        aspect="auto",
        norm=LogNorm(LEAST * largest, largest),
        cmap="viridis",
    )
    left.set_yticks(range(len(order)), [short(study.paths[i], study.joint) for i in order], fontsize=7)
    left.set_xticks(range(study.response.segments), range(1, study.response.segments + 1))
    left.set_xlabel("segment")
    figure.colorbar(image, ax=left, label=f"mu* [{study.response.unit} over the range]")
    spread = np.sqrt((study.effects.deviation**2).mean(axis=1))
    right.loglog(whole[order], np.maximum(spread[order], LEAST * largest), "o", fillstyle="none")
    for i in order[:SHOWN]:
        right.annotate(short(study.paths[i], study.joint), (whole[i], spread[i]), fontsize=6)
    right.set(xlabel=f"mu* [{study.response.unit}]", ylabel=f"sigma [{study.response.unit}]")
    right.grid(alpha=0.25)
    hidden = len(study.paths) - len(order)
    figure.suptitle(
        f"{study.joint}: elementary effects; {hidden} parameters without any are not shown", fontsize=10
    )
    return _png(figure)


def sobol_picture(study: SensitivityStudy, found: SobolIndices) -> bytes:
    """First-order and total index of the parameters that matter most by the latter, which has its interval."""
    from matplotlib.figure import Figure

    order = np.argsort(-found.total_whole, kind="stable")[:SHOWN][::-1]
    rows = np.arange(len(order))
    figure = Figure(figsize=(8.0, 1.2 + 0.28 * len(order)), layout="constrained")
    axis = figure.subplots()
    total = found.total_whole[order]
    miss = np.maximum([total - found.total_low[order], found.total_high[order] - total], 0.0)
    axis.barh(rows + 0.2, total, 0.4, xerr=miss, color="#1b6ca8", label="total", error_kw={"linewidth": 0.8})
    axis.barh(rows - 0.2, np.maximum(found.first_whole[order], 0.0), 0.4, color="#d95f02", label="alone")
    axis.set_yticks(rows, [short(study.paths[i], study.joint) for i in order], fontsize=7)
    axis.set_xlabel("part of the variance of the reading")
    axis.legend(fontsize=8, loc="lower right")
    axis.grid(alpha=0.25, axis="x")
    figure.suptitle(f"{study.joint}: Sobol indices, N = {found.points}", fontsize=10)
    return _png(figure)


def outputs_picture(study: SensitivityStudy) -> bytes:
    """The output over the range of each of the parameters that matter most, one picture each."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    shown = study.ranking[:SHOWN]
    rows = -(-len(shown) // 4)
    figure = Figure(figsize=(13.0, 2.1 * rows + 0.6), layout="constrained")
    grid = figure.subplots(rows, 4, sharex=True, squeeze=False)
    every = max(len(study.response.time) // 800, 1)
    for axis in grid.flat[len(shown) :]:
        axis.set_visible(False)
    for axis, i in zip(grid.flat, shown, strict=False):
        outputs = study.one_at_a_time.outputs[i]
        for output, colour in zip(
            outputs, colormaps["viridis"](np.linspace(0, 1, len(outputs))), strict=True
        ):
            axis.plot(study.response.time[::every], output[::every], color=colour, linewidth=0.6)
        free = study.varied.free[i]
        axis.set_title(f"{short(free.path, study.joint)}\n{free.lower:.4g} to {free.upper:.4g}", fontsize=7)
        axis.tick_params(labelsize=7)
    figure.supxlabel("time [s]", fontsize=9)
    figure.supylabel(f"{study.joint} [{study.response.unit}]", fontsize=9)
    return _png(figure)


def _png(figure: Any) -> bytes:
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return data.getvalue()
