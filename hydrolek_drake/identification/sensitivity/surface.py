"""Performance surface: the objective of an identification over two parameters, figure 4.11."""

import io
import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_results
from hydrolek_drake.identification.objective.norms import mean_norm
from hydrolek_drake.identification.parameter_set import Free, ParameterSet
from hydrolek_drake.identification.sensitivity.response import response_of
from hydrolek_drake.identification.sensitivity.varied import varied_parameters
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.readings import measured_position, position_key
from hydrolek_drake.rigs import Rig

PLACES = 21
"""Values of each parameter."""


@dataclass(frozen=True)
class PerformanceSurface:
    """Largest output error over two parameters, all others as the rig has them.

    Attributes:
        joint: whose reading.
        free: the two parameters.
        units: of their values.
        values: that each was given (SI). # (2, PLACES)
        error: infinity norm (4.13) of the output error, NaN where the model diverged. # (PLACES, PLACES)
        error_unit: "deg" or "mm".
        own: values of the rig (SI).
        measured: whether the error is against a recorded reading, else against the rig's own.
    """

    joint: str
    free: tuple[Free, ...]
    units: tuple[str, ...]
    values: np.ndarray
    error: np.ndarray
    error_unit: str
    own: tuple[float, ...]
    measured: bool

    @property
    def best(self) -> tuple[float, float, float]:
        """Values of the two parameters (SI) where the error is smallest on the grid, and that error."""
        i, j = np.unravel_index(int(np.nanargmin(self.error)), self.error.shape)
        return float(self.values[0, i]), float(self.values[1, j]), float(self.error[i, j])

    def sentence(self) -> str:
        """Where the smallest error lies."""
        first, second, least = self.best
        against = "the recording" if self.measured else "the rig's own reading"
        return (
            f"{self.joint}: largest error against {against} {least:.3g} to {np.nanmax(self.error):.3g} "
            f"{self.error_unit}; smallest at {self.free[0].path} {first:.4g} {self.units[0]}, "
            f"{self.free[1].path} {second:.4g} {self.units[1]}"
        )


def performance_surface(
    rig: Rig,
    joint: str,
    paths: tuple[str, str],
    rng: np.random.Generator,
    *,
    recording: Recording | None = None,
    spread: float = 0.2,
    places: int = PLACES,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> PerformanceSurface:
    """Simulate a joint on a grid over two parameters.

    Args:
        rig: the machine.
        joint: its joint.
        paths: of the two parameters.
        rng: draws the command where no recording is given.
        recording: whose command drives the joint; with a position, the error is against that.
        spread: part of its value by which a parameter without a range is varied.
        places: values of each parameter.
        progress: told how many simulations are done, and of how many.

    Raises:
        InputError: parameters that cannot be varied or are the same, or a recording without a command; the
            model diverges everywhere.
    """
    varied = varied_parameters(rig, joint, spread, list(paths))
    if len(varied.free) != len(paths) or varied.free[0].path == varied.free[1].path:
        reasons = "; ".join(f"{path}: {reason}" for path, reason in varied.left_out.items())
        raise InputError(
            f"--surface {' '.join(paths)}: give two different parameters that can be varied of {joint}"
            + (f" ({reasons})" if reasons else "")
        )
    parameters = ParameterSet(rig, varied.free)
    response = response_of(rig, joint, parameters, 1, recording, rng)
    measured = recording is not None and (
        position_key(rig, joint) in recording.signals or f"{joint}.pot" in recording.signals
    )
    if measured:
        assert recording is not None
        wanted = response.factor * np.asarray(measured_position(rig, joint, recording), dtype=float)
    else:
        wanted = response(parameters.unit())
    seen = np.isfinite(wanted)
    error = np.full((places, places), np.nan)
    grid = np.linspace(0.0, 1.0, places)
    for i, first in enumerate(grid):
        for j, output in enumerate(response.of_all([np.array([first, second]) for second in grid])):
            if np.isfinite(output).all():
                error[i, j] = mean_norm((wanted - output)[seen], math.inf)
        progress((i + 1) * places, places * places)
    if np.isnan(error).all():
        raise InputError(
            f"--surface {' '.join(paths)}: {joint} diverges on the whole grid; give narrower ranges"
        )
    found = parameters.free
    return PerformanceSurface(
        joint,
        tuple(found),
        tuple(rig.entries[one.path].unit for one in found),
        np.array([[one.from_unit(float(u)) for u in grid] for one in found]),
        error,
        response.unit,
        tuple(rig.value(one.path) for one in found),
        measured,
    )


def write_surface(surface: PerformanceSurface, folder: Path) -> list[Path]:
    """Write `surface_<joint>.json` and a picture, each when complete; returns the paths."""
    tree = {
        "joint": surface.joint,
        "against": "recording" if surface.measured else "rig",
        "parameters": [
            {"path": one.path, "unit": unit, "values": values.tolist(), "own": own}
            for one, unit, values, own in zip(
                surface.free, surface.units, surface.values, surface.own, strict=True
            )
        ],
        "error_unit": surface.error_unit,
        "largest_error": [
            [None if np.isnan(value) else float(value) for value in row] for row in surface.error
        ],
    }
    contents: dict[str, bytes | str] = {
        f"surface_{surface.joint}.json": (json.dumps(tree, indent=1) + "\n").encode(),
        f"surface_{surface.joint}.png": surface_png(surface),
    }
    return write_results(folder, contents)


def surface_png(surface: PerformanceSurface) -> bytes:
    """The surface as figure 4.11 has it, and its lines of equal error, which show a valley better."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 5.0), layout="constrained")
    labels = [
        f"{one.path.removeprefix(f'joints.{surface.joint}.')} [{unit}]"
        for one, unit in zip(surface.free, surface.units, strict=True)
    ]
    level = f"largest error [{surface.error_unit}]"
    a, b = np.meshgrid(*surface.values, indexing="ij")
    solid: Any = figure.add_subplot(1, 2, 1, projection="3d")
    solid.plot_surface(a, b, surface.error, cmap="viridis", linewidth=0)
    solid.set_xlabel(labels[0], fontsize=8)
    solid.set_ylabel(labels[1], fontsize=8)
    solid.set_zlabel(level, fontsize=8)
    solid.tick_params(labelsize=7)
    solid.set_box_aspect(None, zoom=0.85)
    flat: Any = figure.add_subplot(1, 2, 2)
    image = flat.contourf(a, b, surface.error, levels=16, cmap="viridis")
    figure.colorbar(image, ax=flat, label=level)
    flat.plot(*surface.own, "wo", markeredgecolor="black", label="the rig")
    flat.plot(*surface.best[:2], "wx", markersize=8, label="smallest on the grid")
    flat.set(xlabel=labels[0], ylabel=labels[1])
    flat.legend(fontsize=8, facecolor="#777777", labelcolor="white")
    against = "a recording" if surface.measured else "the rig's own reading"
    figure.suptitle(f"{surface.joint}: infinity norm (4.13) of the error against {against}", fontsize=10)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return data.getvalue()
