"""Profiles of a fitted rig's parameters: computed on request, written, drawn."""

import io
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_results
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit.fitting import SIGNALS, RigFit
from hydrolek_drake.identification.least_squares.profile import CONFIDENCE, Profile, profile
from hydrolek_drake.identification.parameter_set import Free
from hydrolek_drake.identification.problem_together import problem_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig


@dataclass(frozen=True)
class RigProfile:
    """A profile with the parameter's values.

    Attributes:
        free: the parameter.
        unit: of its value.
        curve: places and growth.
        fitted: value where the fit ended (SI).
        deviation: standard error there, as a part of the range, scaled by the misfit.
    """

    free: Free
    unit: str
    curve: Profile
    fitted: float
    deviation: float

    @property
    def interval(self) -> tuple[float | None, float | None]:
        """Ends (SI); None where the recordings do not bound the parameter within its range."""
        low, high = (
            None if end is None else self.free.from_unit(end) for end in (self.curve.low, self.curve.high)
        )
        return low, high

    def sentence(self) -> str:
        """The interval, and what is odd about it."""
        low, high = self.interval
        text = (
            f"{self.free.path}: profile likelihood, {100 * CONFIDENCE:g} %: "
            f"{self._end(low, 0)} to {self._end(high, -1)} {self.unit}"
        )
        if self.curve.improved > self.curve.threshold:
            text += "; on the way a better fit was found: fit again from there, or with more starts"
        if self.curve.interrupted:
            text += "; interrupted"
        return text

    def _end(self, value: float | None, last: int) -> str:
        """An end of the interval; of a side that has none whether its range ended before, or the curve was cut off.

        Args:
            value: the end (SI); None where there is none.
            last: of the curve's places on that side, 0 or -1.
        """
        if value is not None:
            return f"{value:.6g}"
        place = float(self.curve.places[last])
        told = f"{self.free.from_unit(place):.6g}"
        if place == (0.0 if last == 0 else 1.0):
            return f"not bounded {'above' if last == 0 else 'below'} {told}"
        return f"{'less' if last == 0 else 'more'} than {told}, how far was not computed"


def check_profiled(rig: Rig, wanted: Sequence[str], fitted: Sequence[str]) -> list[str]:
    """Full paths of the parameters of which a profile is wanted.

    Raises:
        InputError: one that is not fitted.
    """
    paths = [rig.full_path(path) for path in wanted]
    for path in paths:
        if path not in fitted:
            raise InputError(f"--profile {path}: is not fitted; choose {', '.join(fitted)}")
    return paths


def profiles_of(
    fitted: RigFit,
    recordings: Sequence[Recording],
    paths: Sequence[str],
    progress: Callable[[str], None] = lambda text: None,
) -> list[RigProfile]:
    """Profiles about a fit; Ctrl-C ends with those that were begun.

    Args:
        fitted: what `fit_rig` found.
        recordings: that it was fitted to.
        paths: full paths.
        progress: told what is done.
    """
    rig = fitted.parameters.rig
    problem = problem_of(
        fitted.parameters,
        [one for recording in recordings for one in experiments_of(rig, recording, SIGNALS)],
    )
    found = []
    for path in paths:
        index = fitted.parameters.paths.index(path)
        free = fitted.parameters.free[index]
        curve = profile(
            problem,
            fitted.unit,
            index,
            float(fitted.known.deviation[index]),
            progress=lambda place, growth, path=path, free=free: progress(  # type: ignore[misc]
                f"profile of {path}: {free.from_unit(place):.6g}, squares grown by {growth:.2f}"
            ),
        )
        deviation = float(fitted.known.deviation[index]) * max(fitted.over_noise, 1.0)
        value = free.from_unit(float(fitted.unit[index]))
        found.append(RigProfile(free, rig.entries[path].unit, curve, value, deviation))
        if curve.interrupted:
            break
    return found


def write_profiles(profiles: Sequence[RigProfile], folder: Path) -> list[Path]:
    """Write `profiles.json` and `profiles.png`, each when complete."""
    rows = [
        {
            "path": one.free.path,
            "unit": one.unit,
            "confidence": CONFIDENCE,
            "fitted": one.fitted,
            "low": one.interval[0],
            "high": one.interval[1],
            "threshold": one.curve.threshold,
            "values": [one.free.from_unit(float(u)) for u in one.curve.places],
            "growth": one.curve.growth.tolist(),
            "improved": one.curve.improved,
            "evaluations": one.curve.evaluations,
            "interrupted": one.curve.interrupted,
        }
        for one in profiles
    ]
    contents = {
        "profiles.json": (json.dumps(rows, indent=1) + "\n").encode(),
        "profiles.png": profiles_picture(profiles),
    }
    return write_results(folder, contents)


def profiles_picture(profiles: Sequence[RigProfile]) -> bytes:
    """Each profile with the threshold, and the parabola that the standard error stands for."""
    from matplotlib.figure import Figure

    columns = min(len(profiles), 3)
    rows = -(-len(profiles) // columns)
    figure = Figure(figsize=(4.0 * columns, 3.0 * rows + 0.3), layout="constrained")
    grid: Any = figure.subplots(rows, columns, squeeze=False)
    for axis in grid.flat[len(profiles) :]:
        axis.set_visible(False)
    for axis, one in zip(grid.flat, profiles, strict=False):
        values = [one.free.from_unit(float(u)) for u in one.curve.places]
        axis.plot(values, one.curve.growth, "o-", color="#1b6ca8", markersize=3, label="profile")
        dense = np.linspace(one.curve.places[0], one.curve.places[-1], 200)
        if np.isfinite(one.deviation) and one.deviation > 0.0:
            parabola = ((dense - one.free.to_unit(one.fitted)) / one.deviation) ** 2
            at = [one.free.from_unit(float(u)) for u in dense]
            axis.plot(at, parabola, color="#d95f02", linewidth=0.9, label="from the standard error")
        axis.axhline(one.curve.threshold, color="#222222", linestyle="--", linewidth=0.8, label="95 %")
        axis.set_ylim(-0.1, 2.0 * one.curve.threshold)
        axis.set_xlabel(f"{one.free.path} [{one.unit}]", fontsize=7)
        axis.tick_params(labelsize=7)
        axis.grid(alpha=0.25)
    grid[0, 0].set_ylabel("growth of the squares", fontsize=8)
    grid[0, 0].legend(fontsize=7)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return data.getvalue()
