"""Forms of PIP in its forward path, with the inverse of the dead-zone."""

import itertools
from dataclasses import replace

import numpy as np

from hydrolek_drake.control.design import integrator, lq_gains
from hydrolek_drake.control.laws.inverse_dead_zone import InverseDeadZone, inverse_dead_zone
from hydrolek_drake.control.models.sdp_model import thesis_model
from hydrolek_drake.control.thesis_gains import entry, voltage_limit_V
from thesis_forms.plants import DURATION_S, MODEL_S, RATIO, SIZE_DEG, Array, Form, Plants, measures

LAWS = ("exponential", "linear")
INVERSES = ("of (6.3)", "of (6.20), secants", "of (6.20), its lines", "of j1", "of j2", "of j3")
"""Inverse dead-zone by the exponential law or, which only joint 4 has, the linear one: by secants as in 6.1.5, or by
the lines of (6.20) themselves, which cut zero within the dead-zone; and those of the other joints, in case of a
mix-up."""

USED: Form = {
    "gains": "printed", "law": LAWS[0], "inverse": INVERSES[0], "late": 1, "fed back": "limited", "internal delay": 0,
    "chatter": 0.05, "model at 0.05 s": False, "plant delay": 0,
}  # fmt: skip
"""What `control/laws/forward_path.py` is."""


def idz_voltages(element: InverseDeadZone, output: Array, chatter: Array) -> Array:
    """`InverseDeadZone.voltage` of many outputs with a chatter band each."""
    up = np.minimum(output / element.slope_positive + element.edge_positive_V, element.highest_V)
    down = np.maximum(output / element.slope_negative + element.edge_negative_V, element.lowest_V)
    return np.select([output > chatter, output < -chatter], [up, down], 0.0)


def gains_of(joint: str, tuning: str) -> tuple[list[float], float, float]:
    """g, f0 and k_I of a printed filter of Table 6.8.

    den = (1 - z^-1)(1 + g_1 z^-1 + ...) + f_0 z^-p, num = k_I (1 - z^-1).
    """
    found = entry(f"pip_forward.{tuning}", joint)
    den = [float(value) for value in found["den"]]
    g, total = [], 1.0
    for value in den[1:-2]:
        total += value
        g.append(total)
    g.append(-den[-1])
    return g, den[-2] - g[-1] + g[-2], float(found["num"][0])


def denominator(g: list[float], f0: float, place: int) -> list[float]:
    """Denominator with the internal model's output `place` samples late."""
    den = np.convolve([1.0, -1.0], [1.0, *g])
    den = np.pad(den, (0, max(place + 1 - len(den), 0)))
    den[place] += f0
    return den.tolist()


def forward_forms(joint: str, tuning: str) -> list[Form]:
    """All forms of the forward path of one joint."""
    g, f0, k_i = gains_of(joint, tuning)
    plant = round(thesis_model(joint).delay_samples / RATIO)
    designs = {"printed": (g, f0, k_i)}
    if joint == "j4":  # printed for a delay of seven samples, the model has five
        lq = lq_gains(integrator(plant, 1.0), *entry(f"pip_forward.{tuning}", joint)["weights"])
        designs["printed, first gains"] = (g[: plant - 1], f0, k_i)
        designs["LQ of delay 5"] = (list(lq.g), lq.f[0], lq.k_i)
    laws = tuple(itertools.product(LAWS, INVERSES)) if joint == "j4" else ((LAWS[0], INVERSES[0]),)
    forms = []
    for design, (law, inverse), late, fed, place, chatter, slow, delay, sign in itertools.product(
        designs, laws, (0, 1, 2), ("raw", "limited", "beyond chatter", "as the valve moves"), (-1, 0, 1, 2),
        (0.05, 0.0), (False, True), (-1, 0, 1, 2), (1, -1),
    ):  # fmt: skip
        values = designs[design]
        forms.append(
            {
                "gains": design, "law": law, "inverse": inverse, "late": late, "fed back": fed, "internal delay": place,
                "chatter": chatter, "model at 0.05 s": slow, "plant delay": delay, "direction": sign,
                "den": denominator(values[0], values[1], len(values[0]) + place), "k_i": values[2],
            }
        )  # fmt: skip
    return forms


def inverse_of(joint: str, which: str) -> InverseDeadZone:
    """The inverse dead-zone of `INVERSES`."""
    if which == INVERSES[0]:
        return inverse_dead_zone(thesis_model(joint), voltage_limit_V())
    if which.startswith("of j"):
        return inverse_dead_zone(thesis_model(which.removeprefix("of ")), voltage_limit_V())
    model = thesis_model("j4_linear")
    element = inverse_dead_zone(model, voltage_limit_V())
    if which == INVERSES[1]:
        return element
    a1, a2, a3, a4 = model.alpha
    return replace(
        element,
        slope_negative=RATIO * a2,
        slope_positive=RATIO * a4,
        edge_negative_V=-a1 / a2,
        edge_positive_V=-a3 / a4,
    )


def run_forward(joint: str, forms: list[Form]) -> Array:
    """Measures of forms of one plant law, shape (2, 2, n)."""
    model = thesis_model("j4_linear" if forms[0]["law"] == "linear" else joint)
    element = inverse_of(joint, str(forms[0]["inverse"]))
    column = {key: np.array([form[key] for form in forms]) for key in forms[0] if key != "den"}
    longest = max(len(form["den"]) for form in forms)
    den = np.array([np.pad(form["den"], (0, longest - len(form["den"]))) for form in forms]).T
    plants = Plants(
        model, column["model at 0.05 s"].astype(bool),
        np.maximum(model.delay_samples + RATIO * column["plant delay"], 1),
    )  # fmt: skip
    low, high = element.limits
    fed = column["fed back"]
    late, chatter, k_i = column["late"].astype(int), column["chatter"], column["k_i"]
    wanted = SIZE_DEG * column["direction"]
    errors = np.zeros((3, len(forms)))
    past = np.zeros((longest - 1, len(forms)))
    angles = np.empty((round(DURATION_S / MODEL_S), len(forms)))
    volts = np.zeros(len(forms))
    for k in range(len(angles)):
        if k % RATIO == 0:
            errors = np.vstack([[wanted - plants.angle], errors[:-1]])
            output = k_i * errors[late, np.arange(len(forms))] - (den[1:] * past).sum(axis=0)
            volts = idz_voltages(element, output, chatter)
            limited = np.clip(output, low, high)
            kept = np.select(
                [fed == "raw", fed == "limited", fed == "beyond chatter"],
                [np.clip(output, -1e6, 1e6), limited, np.where(np.abs(limited) > chatter, limited, 0.0)],
                RATIO * model.increment(volts),
            )
            past = np.vstack([[kept], past[:-1]])
        angles[k] = plants.step(volts)
    return measures(angles * column["direction"], SIZE_DEG)
