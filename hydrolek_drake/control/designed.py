"""From an SDP model to a ready controller in one step, as a file."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hydrolek_drake.control.design import (
    PipGains,
    closed_loop_poles,
    forward_path,
    integrator,
    lq_gains,
    pole_gains,
)
from hydrolek_drake.control.forward_path import ForwardPathLaw
from hydrolek_drake.control.guard import GuardedLaw, guarded
from hydrolek_drake.control.inverse_dead_zone import InverseDeadZone, inverse_dead_zone
from hydrolek_drake.control.law import ControlLaw
from hydrolek_drake.control.pip import PipLaw
from hydrolek_drake.control.sdp_model import SdpModel, thesis_data
from hydrolek_drake.control.thesis_gains import sample_s, voltage_limit_V
from hydrolek_drake.errors import InputError
from hydrolek_drake.yaml_files import read_yaml


@dataclass(frozen=True)
class Designed:
    """A PIP controller with inverse dead-zone, designed for one joint.

    Attributes:
        model: that it was designed for.
        delay: of the design, in control samples.
        gains: of the feedback form.
        inverse: dead-zone.
        poles: of the closed loop on the linear model.
    """

    model: SdpModel
    delay: int
    gains: PipGains
    inverse: InverseDeadZone
    poles: tuple[complex, ...]

    def law(self, *, noisy: bool, forward: bool = False) -> GuardedLaw:
        """The guarded law, in feedback or forward-path form."""
        law: ControlLaw = PipLaw(self.gains, self.inverse)
        if forward:
            num, den = forward_path(self.gains, integrator(max(self.delay - 1, 1)))
            law = ForwardPathLaw(num, den, self.inverse)
        limits = (self.model.lower_deg, self.model.upper_deg)
        return guarded(law, limits, self.model.dead_zone_V, sample_s(), noisy=noisy)

    def as_tree(self) -> dict[str, Any]:
        """Content of the file that `write_designed` writes."""
        return {
            "schema": 1,
            "joint": self.model.name,
            "sample_s": sample_s(),
            "model": {
                "alpha": list(self.model.alpha),
                "beta": None if self.model.beta is None else list(self.model.beta),
                "sample_s": self.model.sample_s,
                "delay_samples": self.model.delay_samples,
                "range_deg": [self.model.lower_deg, self.model.upper_deg],
            },
            "delay_control_samples": self.delay,
            "gains": {"f": list(self.gains.f), "g": list(self.gains.g), "k_i": self.gains.k_i},
            "inverse_dead_zone": {
                "slope_negative": self.inverse.slope_negative,
                "slope_positive": self.inverse.slope_positive,
                "edge_negative_V": self.inverse.edge_negative_V,
                "edge_positive_V": self.inverse.edge_positive_V,
                "chatter": self.inverse.chatter,
            },
            "closed_loop_poles": [[float(p.real), float(p.imag)] for p in self.poles],
        }


def design_controller(
    model: SdpModel,
    *,
    weights: tuple[float, float, float] | None = None,
    poles: tuple[complex, ...] | None = None,
) -> Designed:
    """Gains and inverse dead-zone for a joint, thesis sections 6.1.5, 6.2.2 and 6.2.5.

    Args:
        model: exponential or linear law.
        weights: of the integral of error, inputs and output, for LQ.
        poles: of the closed loop, for pole placement; exactly one of both is given.

    Raises:
        InputError: both or none given, or an impossible design.
    """
    if (weights is None) == (poles is None):
        raise InputError("a design needs either LQ weights or poles")
    delay = max(round(model.delay_samples * model.sample_s / sample_s()), 1)
    plant = integrator(delay)
    gains = lq_gains(plant, *weights) if weights is not None else pole_gains(plant, list(poles or ()))
    found = closed_loop_poles(plant, gains)
    inverse = inverse_dead_zone(model, voltage_limit_V(), until_saturation=True)
    return Designed(model, delay, gains, inverse, tuple(complex(p) for p in np.sort_complex(found)))


def is_model_file(path: Path) -> bool:
    """Whether a YAML file holds an SDP model, and not a rig: it has `alpha`, or `model` with it."""
    try:
        tree = read_yaml(path, "file")
    except InputError:
        return False  # whoever reads it as a rig says what is wrong
    return isinstance(tree, dict) and ("alpha" in tree or "model" in tree)


def read_model(path: Path) -> SdpModel:
    """An SDP model from a YAML file with alpha (and beta), delay_samples, range_deg, and optionally sample_s, joint.

    A file that `hydrolek control design` wrote is read too.

    Raises:
        InputError: not readable, or a value missing or wrong.
    """
    tree = read_yaml(path, "model")
    if not isinstance(tree, dict):
        raise InputError(f"model {path} must be a mapping with alpha, delay_samples and range_deg")
    inner = tree.get("model", tree)
    try:
        beta = inner.get("beta")
        model = SdpModel(
            name=str(tree.get("joint", path.stem)),
            alpha=tuple(float(value) for value in inner["alpha"]),
            beta=None if beta is None else tuple(float(value) for value in beta),
            sample_s=float(inner.get("sample_s", thesis_data()["sample"]["value"])),
            delay_samples=int(inner["delay_samples"]),
            lower_deg=float(inner["range_deg"][0]),
            upper_deg=float(inner["range_deg"][1]),
        )
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise InputError(
            f"model {path}: {error}; needed are alpha (6 numbers, or 4 with beta of 6), delay_samples and "
            "range_deg (2 numbers)"
        ) from None
    counts = (len(model.alpha), 0 if model.beta is None else len(model.beta))
    if counts not in ((6, 0), (4, 6)):
        raise InputError(
            f"model {path}: alpha has {counts[0]} and beta {counts[1]} numbers; give 6 and none, or 4 and 6"
        )
    if not (model.alpha[0] < 0.0 or model.beta is not None) or model.lower_deg >= model.upper_deg:
        raise InputError(f"model {path}: alpha begins with the negative rate, and range_deg rises")
    return model


def write_designed(designed: Designed, path: Path) -> None:
    """Write a designed controller as YAML, complete or not at all.

    Raises:
        InputError: the file cannot be written.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(yaml.safe_dump(designed.as_tree(), sort_keys=False), encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise InputError(f"--out {path}: cannot write there: {error.strerror or error}") from None
    finally:
        part.unlink(missing_ok=True)
