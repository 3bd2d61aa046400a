"""What `hydrolek identify sdp` writes: numbers as JSON and YAML, pictures like figures 6.3 and 6.4."""

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hydrolek_drake.control.models.sdp_model import thesis_data
from hydrolek_drake.files import write_results
from hydrolek_drake.identification.sdp.identify import SdpIdentification
from hydrolek_drake.identification.sdp.step_test import campaign_data
from hydrolek_drake.identification.sdp.validation import KINDS, ValidationRun


def mean_errors(runs: Sequence[ValidationRun]) -> dict[str, float]:
    """Mean squared error of each kind [deg^2], as in Table 6.2."""
    return {
        kind: float(np.mean([run.mean_squared_error for run in runs if run.kind == kind]))
        for kind in KINDS
        if any(run.kind == kind for run in runs)
    }


def as_json(found: SdpIdentification, runs: Sequence[ValidationRun]) -> dict[str, Any]:
    """All numbers of a joint; infinite errors and missing dead times become null."""
    inverse = found.inverse
    return {
        "joint": found.joint,
        "sample_s": found.model.sample_s,
        "delay_samples": found.model.delay_samples,
        "exponential": _law(found.exponential.values, found.exponential.errors),
        "linear": {
            "alpha": _law(found.linear[0].values, found.linear[0].errors),
            "beta": _law(found.linear[1].values, found.linear[1].errors),
        },
        "inverse_dead_zone": {
            "s_n": inverse.slope_negative,
            "s_p": inverse.slope_positive,
            "alpha3_V": inverse.edge_negative_V,
            "alpha6_V": inverse.edge_positive_V,
            "chatter": inverse.chatter,
        },
        "steps": [
            {
                "level_V": step.level_V,
                "b": step.b,
                "b_error": _finite(step.b_error),
                "rate_deg_per_s": step.rate_deg_per_s,
                "dead_time_s": _finite(step.dead_time_s),
                "a1": _finite(step.a1),
                "moving": step.moving,
            }
            for step in found.steps
        ],
        "validation_mean_squared_error_deg2": mean_errors(runs),
    }


def as_model_entry(found: SdpIdentification) -> dict[str, Any]:
    """The joint as `control/models/sdp_models.yaml` writes it."""
    return {
        "law": "exponential",
        "alpha": [round(value, 5) for value in found.exponential.values],
        "delay_samples": found.model.delay_samples,
        "range_deg": [round(found.model.lower_deg, 2), round(found.model.upper_deg, 2)],
    }


def write_report(
    results: Sequence[tuple[SdpIdentification, Sequence[ValidationRun]]], folder: Path
) -> list[Path]:
    """Write `sdp.json`, `sdp_models.yaml` and a picture for each joint; returns the paths."""
    models = {
        "sample": {"value": results[0][0].model.sample_s, "unit": "s"},
        "joints": {found.joint: as_model_entry(found) for found, _ in results},
    }
    contents: dict[str, bytes] = {
        "sdp.json": (json.dumps([as_json(*result) for result in results], indent=1) + "\n").encode(),
        "sdp_models.yaml": yaml.safe_dump(models, sort_keys=False).encode(),
        **{f"sdp_{found.joint}.png": picture(found, runs) for found, runs in results},
    }
    return write_results(folder, contents)


def picture(found: SdpIdentification, runs: Sequence[ValidationRun]) -> bytes:
    """Rate and dead time against voltage (figures 6.3, 6.6, 6.22), a validation run of each kind (6.4, appendix E)."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 8.5), layout="constrained")
    grid: Any = figure.subplots(3, 2, height_ratios=[1.2, 1.0, 0.5])
    control_sample_s = float(thesis_data()["inverse"]["sample"]["value"])
    level = np.array([step.level_V for step in found.steps])
    fine = np.linspace(level.min(), level.max(), 801)
    rates, dead = grid[0]
    rates.plot(fine, found.model.rate(fine), label="exponential law (6.3)")
    rates.plot(fine, found.linear_model.rate(fine), linestyle="--", label="linear law (6.20)")
    secants = [found.inverse.increment(float(v)) / control_sample_s for v in fine]
    rates.plot(fine, secants, color="#555555", linewidth=0.8, label="inverse dead-zone's secants (6.4)")
    slowest, fastest = found.model.saturation_deg_per_s
    rates.set_ylim(1.3 * slowest, 1.3 * fastest)
    rates.plot(
        level, [step.rate_deg_per_s for step in found.steps], "o", label="step tests", fillstyle="none"
    )
    rates.set(xlabel="voltage [V]", ylabel="angular velocity [deg/s]")
    rates.legend(fontsize=8)
    dead.plot(level, [step.dead_time_s for step in found.steps], "o", fillstyle="none")
    dead.axhline(found.model.delay_samples * found.model.sample_s, linestyle="--", label="used")
    dead.set(xlabel="voltage [V]", ylabel="dead time [s]", ylim=(0.0, None))
    dead.legend(fontsize=8)
    for axis, under, kind in zip(grid[1], grid[2], KINDS, strict=True):
        run = next((run for run in runs if run.kind == kind), None)
        axis.set_visible(run is not None)
        under.set_visible(run is not None)
        if run is not None:
            time = np.arange(len(run.voltage_V)) * found.model.sample_s
            axis.plot(time, run.machine_deg, label="machine", linewidth=0.9)
            axis.plot(time, run.model_deg, label="SDP model", linewidth=0.9)
            axis.set_title(f"{kind}: {run.mean_squared_error:.3g} deg²", fontsize=9)
            axis.set_ylabel("angle [deg]")
            axis.legend(fontsize=8)
            axis.sharex(under)
            axis.tick_params(labelbottom=False)
            under.plot(time, run.voltage_V, linewidth=0.6, color="#555555")
            under.set(xlabel="time [s]", ylabel="voltage [V]")
    for axis in grid.flat:
        axis.grid(alpha=0.25)
    figure.suptitle(f"SDP model of {found.joint}", fontsize=10)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return data.getvalue()


def thesis_error(kind: str, joint: str) -> float | None:
    """Table 6.2, for joints of the right arm; None for others."""
    table: dict[str, float] = campaign_data()["table_6_2"][kind]
    return table.get(joint.removeprefix("right_"))


def _law(values: Sequence[float], errors: Sequence[float]) -> dict[str, list[float | None]]:
    return {"values": list(values), "errors": [_finite(error) for error in errors]}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
