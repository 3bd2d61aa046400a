"""Forms of PI with its scaled input."""

import itertools

import numpy as np

from hydrolek_drake.control.laws.scaled_input import ScaledInput
from hydrolek_drake.control.models.sdp_model import thesis_model
from hydrolek_drake.control.thesis_gains import scaled_input, voltage_limit_V
from thesis_forms.plants import DURATION_S, MODEL_S, RATIO, SIZE_DEG, Array, Form, Plants, measures

USED_PI: Form = {
    "K_I": "per s", "rule": "backward", "anti-windup": False, "signal limited": True, "printed (6.7)": False,
    "model at 0.05 s": False, "plant delay": 0, "K_P times integral": False,
}  # fmt: skip
"""What `control/laws/pi.py` is in the thesis's form."""


def scaled_voltages(element: ScaledInput, output: Array, form: dict[str, Array]) -> Array:
    """`ScaledInput.voltage` of many outputs: limited by (6.8) or not, and (6.7) with its printed sign or not."""
    signal = np.where(form["signal limited"], np.clip(output, -element.full, element.full), output)
    sign = np.where(form["printed (6.7)"], -1.0, 1.0)
    down = element.dead_negative_V + sign * signal * element.factor_negative
    volts = np.select(
        [signal > 0, signal < 0], [element.dead_positive_V + signal * element.factor_positive, down], 0.0
    )
    limit = voltage_limit_V()
    return np.clip(
        volts,
        np.where(form["(6.8)"], element.lowest_V, -limit),
        np.where(form["(6.8)"], element.highest_V, limit),
    )


def pi_forms(gains: list[tuple[float, float]]) -> list[Form]:
    """All forms of PI with these K_P and K_I."""
    forms = []
    for pair, unit, rule, windup, limited, six8, printed, slow, delay, sign, ideal in itertools.product(
        gains, ("per s", "per sample"), ("backward", "forward", "trapezoidal"), (False, True), (True, False),
        (True, False), (False, True), (False, True), (-1, 0, 1), (1, -1), (False, True),
    ):  # fmt: skip
        forms.append(
            {
                "k_p": pair[0], "k_i": pair[1] * (pair[0] if ideal else 1.0), "K_I": unit, "rule": rule,
                "anti-windup": windup, "signal limited": limited, "(6.8)": six8, "printed (6.7)": printed,
                "model at 0.05 s": slow, "plant delay": delay, "direction": sign, "K_P times integral": ideal,
            }
        )  # fmt: skip
    return forms


def run_pi(joint: str, forms: list[Form], ratio: int = RATIO) -> Array:
    """Measures of forms of PI, the controller run every `ratio` model samples, shape (2, 2, n)."""
    model, element = thesis_model(joint), scaled_input(joint)
    form = {key: np.array([each[key] for each in forms]) for key in forms[0]}
    plants = Plants(
        model, form["model at 0.05 s"].astype(bool),
        np.maximum(model.delay_samples + RATIO * form["plant delay"], 1),
    )  # fmt: skip
    period = np.where(form["K_I"] == "per s", ratio * MODEL_S, 1.0)
    wanted = SIZE_DEG * form["direction"]
    total, before, volts = np.zeros(len(forms)), np.zeros(len(forms)), np.zeros(len(forms))
    angles = np.empty((round(DURATION_S / MODEL_S), len(forms)))
    for k in range(len(angles)):
        if k % ratio == 0:
            error = wanted - plants.angle
            new = np.select(
                [form["rule"] == "backward", form["rule"] == "forward"],
                [error, before],
                0.5 * (error + before),
            )
            grown = total + form["k_i"] * period * new
            output = form["k_p"] * error + grown
            stuck = form["anti-windup"] & (np.abs(output) > element.full) & (output * error > 0.0)
            total = np.where(stuck, total, grown)
            volts = scaled_voltages(element, form["k_p"] * error + total, form)
            before = error
        angles[k] = plants.step(volts)
    return measures(angles * form["direction"], SIZE_DEG)
