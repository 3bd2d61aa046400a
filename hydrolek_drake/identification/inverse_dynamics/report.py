"""What `hydrolek identify force` writes: numbers, the rig with them, and the force measured and modelled."""

import io
import json
from pathlib import Path

import yaml

from hydrolek_drake.files import write_results
from hydrolek_drake.identification.inverse_dynamics.regression import Regression
from hydrolek_drake.rigs import Rig


def fitted_rig(rig: Rig, found: Regression) -> Rig:
    """The rig with the estimates; a dry friction that came out below zero is none."""
    values = {path: value for path, (value, _, _) in found.intervals().items()}
    friction = f"joints.{found.joint}.effects.load.coulomb_friction.force_N"
    values[friction] = max(values[friction], 0.0)
    return rig.with_values(values)


def write_regression(rig: Rig, found: Regression, folder: Path) -> list[Path]:
    """Write `force.json`, `force.png` and `rig_fitted.yaml`, each when complete."""
    rows = {
        path: {"value": value, "low": low, "high": high}
        for path, (value, low, high) in found.intervals().items()
    }
    content = {"parameters": rows, "misfit": found.misfit, "correlation": found.correlation}
    contents = {
        "force.json": (json.dumps(content, indent=1) + "\n").encode(),
        "force.png": picture(rig, found),
        "rig_fitted.yaml": yaml.safe_dump(
            fitted_rig(rig, found).as_tree(), sort_keys=False, allow_unicode=True
        ).encode(),
    }
    return write_results(folder, contents)


def picture(rig: Rig, found: Regression) -> bytes:
    """Force of the drive and of the regression over time, and what is left, for each recording."""
    from matplotlib.figure import Figure

    unit = "N" if rig.variant(found.joint, "load") == "sliding" else "N m"
    figure = Figure(figsize=(9.0, 4.5), layout="constrained")
    grid = figure.subplots(
        2, len(found.time), sharex="col", sharey="row", squeeze=False, height_ratios=[2.0, 1.0]
    )
    for column, (time, force, model) in enumerate(zip(found.time, found.force, found.model, strict=True)):
        above, below = grid[0, column], grid[1, column]
        above.plot(time, force, color="#222222", linewidth=0.9, label="drive")
        above.plot(time, model, color="#d95f02", linewidth=0.9, label="inverse dynamics")
        below.plot(time, force - model, color="#1b6ca8", linewidth=0.8)
        below.set_xlabel("time [s]")
        above.grid(alpha=0.25)
        below.grid(alpha=0.25)
    grid[0, 0].set_ylabel(f"force [{unit}]")
    grid[1, 0].set_ylabel(f"drive - model\n[{unit}]")
    grid[0, 0].legend(fontsize=8)
    figure.suptitle(f"{found.joint}: force of the drive", fontsize=10)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return data.getvalue()
