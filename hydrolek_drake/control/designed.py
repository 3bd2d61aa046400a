"""From an SDP model to a ready controller in one step, as a file."""

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
from hydrolek_drake.control.laws.forward_path import ForwardPathLaw
from hydrolek_drake.control.laws.guard import GuardedLaw, guarded
from hydrolek_drake.control.laws.inverse_dead_zone import InverseDeadZone, inverse_dead_zone
from hydrolek_drake.control.laws.law import ControlLaw
from hydrolek_drake.control.laws.pip import PipLaw
from hydrolek_drake.control.models.sdp_model import SdpModel, thesis_data
from hydrolek_drake.control.thesis_gains import sample_s, voltage_limit_V
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_out
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
    if not isinstance(inner, dict):
        raise InputError(f"model {path}: 'model' must be a mapping with alpha, delay_samples and range_deg")
    for key in ("alpha", "delay_samples", "range_deg"):
        if key not in inner:
            raise InputError(f"model {path}: '{key}' is missing; needed are {_NEEDED}")
    alpha = _numbers(inner["alpha"], f"model {path}: alpha")
    beta = None if inner.get("beta") is None else _numbers(inner["beta"], f"model {path}: beta")
    counts = (len(alpha), 0 if beta is None else len(beta))
    if counts not in ((6, 0), (4, 6)):
        raise InputError(
            f"model {path}: alpha has {counts[0]} and beta {counts[1]} numbers; give 6 and none, or 4 and 6"
        )
    ends = _numbers(inner["range_deg"], f"model {path}: range_deg")
    sample = inner.get("sample_s", thesis_data()["sample"]["value"])
    (interval,) = _numbers([sample], f"model {path}: sample_s")
    (delay,) = _numbers([inner["delay_samples"]], f"model {path}: delay_samples")
    if len(ends) != 2 or not ends[0] < ends[1]:
        raise InputError(f"model {path}: range_deg must be two numbers that rise")
    if not _SHORTEST_S <= interval <= _LONGEST_S:
        raise InputError(
            f"model {path}: sample_s {interval:g} s must lie between {_SHORTEST_S:g} and {_LONGEST_S:g} s"
        )
    if delay != int(delay) or not 0.0 <= delay * interval <= _LONGEST_DELAY_S:
        raise InputError(
            f"model {path}: delay_samples {delay:g} must be a whole number of samples, {_LONGEST_DELAY_S:g} s at most"
        )
    model = SdpModel(str(tree.get("joint", path.stem)), alpha, beta, interval, int(delay), *ends)
    if wrong := _contradiction(model):
        raise InputError(f"model {path}: {wrong}")
    return model


_LARGEST = 1e6  # of any number of a model, in volts, degrees, or by sample
_SHORTEST_S, _LONGEST_S = 1e-6, 10.0  # of a sampling interval
_LONGEST_DELAY_S = 2.0  # a design of an order above 40 takes minutes, and controls nothing
_NEEDED = "alpha (6 numbers, or 4 with beta of 6), delay_samples and range_deg (2 numbers)"


def _numbers(raw: Any, where: str) -> tuple[float, ...]:
    if not isinstance(raw, list):
        raise InputError(f"{where}: '{raw}' is no list of numbers; needed are {_NEEDED}")
    try:
        values = [float("nan") if isinstance(each, bool) else float(each) for each in raw]
    except (TypeError, ValueError):
        raise InputError(f"{where}: '{raw}' is no list of numbers; needed are {_NEEDED}") from None
    if not all(abs(value) <= _LARGEST for value in values):
        raise InputError(f"{where}: '{raw}' must be finite numbers of at most {_LARGEST:g}")
    return tuple(values)


_LEAST_DEG = 1e-9  # of a rate by sample, below which it is none


def _contradiction(model: SdpModel) -> str:
    """What is wrong with numbers that cannot be those of a joint; empty if nothing is."""
    rates = model.alpha[::3] if model.beta is None else model.beta[0:3:2]
    if min(map(abs, rates)) < _LEAST_DEG:
        return f"rates of saturation {rates} deg by sample are too small to be any"
    if model.beta is None:
        a1, a2, a3, a4, a5, a6 = model.alpha
        if not (a1 < 0.0 < a4 and a2 > 0.0 and a5 > 0.0 and a3 < a6):
            return (
                "alpha begins with the negative rate, alpha4 is the positive one; alpha2 and alpha5 are above 0, and "
                "alpha3 lies below alpha6"
            )
    else:
        b1, b2, b3, b4, b5, b6 = model.beta
        if not (b1 < 0.0 < b3 and b5 < b2 < b4 < b6 and model.alpha[1] > 0.0 and model.alpha[3] > 0.0):
            return (
                "beta begins with the negative rate, beta3 is the positive one, beta5, beta2, beta4 and beta6 rise, "
                "and the slopes alpha2 and alpha4 are above 0"
            )
    return ""


def write_designed(designed: Designed, path: Path) -> None:
    """Write a designed controller as YAML, complete or not at all.

    Raises:
        InputError: the file cannot be written.
    """
    write_out(path, yaml.safe_dump(designed.as_tree(), sort_keys=False))
