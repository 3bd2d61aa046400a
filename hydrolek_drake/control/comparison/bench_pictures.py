"""Pictures of a comparison beside the signals: the wrist's path, and what fuzzy controllers are made of."""

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.control.catalogue import CONTROLLERS
from hydrolek_drake.control.comparison.bench import Bench, Trial
from hydrolek_drake.control.laws.fuzzy import (
    SETS,
    appendix_f_sets,
    appendix_f_surface,
    fuzzy_data,
    membership,
    printed_surface,
    single_input_surface,
    two_input_surface,
)
from hydrolek_drake.control.thesis_gains import scaled_input

_PLANES = ((0, 1, "horizontal X [m]", "vertical Y [m]"), (0, 2, "horizontal X [m]", "depth Z [m]"))
_SET_POINT = "#222222"
_SHADES = 81  # lines of a drawn control surface at most


def paths_png(bench: Bench, sequence: str, colours: Mapping[str, str]) -> bytes:
    """Path of the wrist in two planes, an arm a row: figures 5.9 and 7.11 (grasp), 6.27 (sine).

    Args:
        bench: with trials of the sequence.
        sequence: of `sequences.NAMES`.
        colours: of each controller.
    """
    from matplotlib.figure import Figure

    trials = [trial for trial in bench.trials if trial.sequence == sequence]
    arms = list(trials[0].wrist_m)
    figure = Figure(figsize=(11.0, 4.6 * len(arms) + 0.9), layout="constrained")
    grid: Any = figure.subplots(len(arms), 2, squeeze=False)
    for row, arm in zip(grid, arms, strict=True):
        for axis, (across, up, *labels) in zip(row, _PLANES, strict=True):
            for trial in _calm(trials):
                reached, _ = trial.wrist_m[arm]
                axis.plot(
                    reached[:, across], reached[:, up], color=colours[trial.controller], linewidth=0.9,
                    label=CONTROLLERS[trial.controller][0],
                )  # fmt: skip
            begin = trials[0].wrist_m[arm][0][0]
            axis.plot(begin[across], begin[up], "x", color=_SET_POINT, label="start", zorder=3)
            _, asked = trials[0].wrist_m[arm]
            style = {"linestyle": "--"} if sequence == "sine" else {"linestyle": "none", "marker": "o"}
            axis.plot(
                asked[:, across], asked[:, up], color=_SET_POINT, label="set points",
                fillstyle="none", zorder=3, **style,
            )  # fmt: skip
            axis.set(xlabel=labels[0], ylabel=labels[1])
            axis.set_aspect("equal", adjustable="datalim")
            axis.grid(alpha=0.25)
        row[0].set_title(arm.replace("_", " "), loc="left", fontsize=9)
    handles, names = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=5, fontsize=8)
    figure.suptitle(f"Path of the wrist, {sequence}", fontsize=10)
    return _png(figure)


def _calm(trials: Sequence[Trial]) -> Sequence[Trial]:
    """Without the one that swings between the voltage's limits and hides all others, if there are others."""
    return [trial for trial in trials if trial.controller != "pip_no_scaling"] or trials


def fuzzy_png(controller: str, joint: str = "j2") -> bytes:
    """Membership functions and control surface of a fuzzy controller: figures 7.3, 7.4, 7.6 and appendix F.

    Args:
        controller: "fuzzy_single", "fuzzy_double", "fuzzy_double_printed" or "fuzzy_appendix_f".
        joint: "j1" to "j4"; only `fuzzy_appendix_f` has sets for each.
    """
    from matplotlib.figure import Figure

    data = fuzzy_data()
    single, volts = controller == "fuzzy_single", controller == "fuzzy_appendix_f"
    sets = appendix_f_sets(scaled_input(joint), joint) if volts else data
    figure = Figure(figsize=(11.0, 6.0), layout="constrained")
    left, right = figure.subfigures(1, 2, squeeze=False)[0]
    kinds = [("error", "error [deg]"), ("output", "output [V]" if volts else "output [deg per sample]")]
    if not single:
        kinds.insert(1, ("change", "change of error [deg per sample]"))
    for axis, (kind, label) in zip(left.subplots(len(kinds), 1), kinds, strict=True):
        _draw_sets(axis, sets[kind], label)
    if single:
        axis = right.subplots()
        axis.plot(*single_input_surface(data), color="#1b6ca8")
        axis.set(xlabel="error: set point less angle [deg]", ylabel="output [deg per sample]")
        axis.grid(alpha=0.25)
    else:
        if volts:
            surface = appendix_f_surface(scaled_input(joint), joint)
        elif controller == "fuzzy_double_printed":
            surface = printed_surface()
        else:
            surface = two_input_surface(data, data["two_input"])
        _draw_surface(right, *surface, kinds[-1][1])
    name = CONTROLLERS[controller][0] + (f", joint {joint[1:]}" if volts else ", all joints")
    figure.suptitle(f"{name}: membership functions and control surface", fontsize=10)
    return _png(figure)


def _draw_sets(axis: Any, sets: Mapping[str, Sequence[float]], label: str) -> None:
    corners = [corner for name in SETS for corner in sets[name] if np.isfinite(corner)]
    margin = 0.1 * (max(corners) - min(corners))
    values = np.unique([*np.linspace(min(corners) - margin, max(corners) + margin, 801), *corners])
    for name in SETS:
        axis.plot(values, membership(values, sets[name]), linewidth=1.1, label=name)
    axis.set(xlabel=label, ylabel="membership")
    axis.legend(fontsize=7, ncols=5, loc="upper center", bbox_to_anchor=(0.5, 1.22))
    axis.grid(alpha=0.25)


def _draw_surface(
    figure: Any,
    errors: NDArray[np.floating],
    changes: NDArray[np.floating],
    surface: NDArray[np.floating],
    label: str,
) -> None:
    axis = figure.add_subplot(projection="3d")
    a, b = np.meshgrid(errors, changes, indexing="ij")
    axis.plot_surface(a, b, surface, cmap="viridis", rcount=_SHADES, ccount=_SHADES, linewidth=0)
    axis.set_xlabel("error: set point less angle [deg]", fontsize=8)
    axis.set_ylabel("change [deg per sample]", fontsize=8)
    axis.set_zlabel(label, fontsize=8)
    axis.tick_params(labelsize=7)
    axis.view_init(25, -120)
    axis.set_box_aspect(None, zoom=0.85)


def fuzzy_pictures(bench: Bench) -> dict[str, bytes]:
    """Name of a file -> picture, of every fuzzy controller that was run."""
    found: dict[str, bytes] = {}
    for name in dict.fromkeys(trial.controller for trial in bench.trials):
        if name == "fuzzy_appendix_f":
            found |= {f"{name}_{joint}.png": fuzzy_png(name, joint) for joint in ("j1", "j2", "j3", "j4")}
        elif name.startswith("fuzzy"):
            found[f"{name}.png"] = fuzzy_png(name)
    return found


def _png(figure: Any) -> bytes:
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return data.getvalue()
