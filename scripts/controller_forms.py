#!/usr/bin/env python3
"""Which form of the forward path and of PI gives the thesis's Tables G.3 and G.4?

Every form of a family is simulated on the SDP models (6.2), (6.3), (6.20), many at a time, for the steps of appendix G,
and judged by the printed rise time and overshoot, each measured against the set point and against the final value, as
MATLAB's `stepinfo` does. Prints the tables of docs/evidence/control.md; in brackets how far a form is off, in what
counts as reproduced (0.03 s, 1.5 points).
"""

import argparse
import itertools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.control.comparison.thesis_tables import STEP_TABLES
from hydrolek_drake.control.design import integrator, lq_gains
from hydrolek_drake.control.laws.inverse_dead_zone import InverseDeadZone, inverse_dead_zone
from hydrolek_drake.control.laws.scaled_input import ScaledInput
from hydrolek_drake.control.models.sdp_model import SdpModel, thesis_model
from hydrolek_drake.control.thesis_gains import entry, scaled_input, voltage_limit_V

Array = NDArray[np.float64]

JOINTS = ("j1", "j2", "j3", "j4")
SIZE_DEG = 30.0
DURATION_S = (
    17.0  # of each of the two steps; the mean squared errors of appendix G fit it (docs/evidence/control.md)
)
MODEL_S, CONTROL_S = 0.01, 0.05
RATIO = round(CONTROL_S / MODEL_S)
RISE_S, OVERSHOOT = 0.03, 1.5  # what counts as reproduced, as for the feedback form (tests/control)
MEASURES = ("set point", "final value")

LAWS = ("exponential", "linear")
INVERSES = ("of (6.3)", "of (6.20), secants", "of (6.20), its lines", "of j1", "of j2", "of j3")
"""Inverse dead-zone by the exponential law or, which only joint 4 has, the linear one: by secants as in 6.1.5, or by
the lines of (6.20) themselves, which cut zero within the dead-zone; and those of the other joints, in case of a
mix-up."""

Form = dict[str, object]

DIRECTION = {"j1": 1, "j2": 1, "j3": -1, "j4": 1}
"""Of the steps, by which the feedback forms reproduce."""

USED: Form = {
    "gains": "printed", "law": LAWS[0], "inverse": INVERSES[0], "late": 1, "fed back": "limited", "internal delay": 0,
    "chatter": 0.05, "model at 0.05 s": False, "plant delay": 0,
}  # fmt: skip
"""What `control/laws/forward_path.py` is."""

USED_PI: Form = {
    "K_I": "per s", "rule": "backward", "anti-windup": False, "signal limited": True, "printed (6.7)": False,
    "model at 0.05 s": False, "plant delay": 0, "K_P times integral": False,
}  # fmt: skip
"""What `control/laws/pi.py` is in the thesis's form."""


@dataclass
class Plants:
    """SDP models under many controllers at once: one column a form.

    Attributes:
        model: of the joint.
        slow: whether the model itself runs at the control sample. # (n,)
        delay: in model samples. # (n,)
    """

    model: SdpModel
    slow: NDArray[np.bool_]
    delay: NDArray[np.int_]

    def __post_init__(self) -> None:
        self.angle = np.zeros(len(self.delay))
        self.line = np.zeros((int(self.delay.max()) + 2, len(self.delay)))
        self.k = 0

    def step(self, volts: Array) -> Array:
        """One model sample: angles before it [deg]."""
        before = self.angle
        self.line[self.k % len(self.line)] = volts
        past = self.k + 1 - self.delay
        arriving = np.where(past >= 0, self.line[past % len(self.line), np.arange(len(past))], 0.0)
        moved = self.model.increment(arriving)
        if self.slow.any():
            due = (self.k + 1) % RATIO == 0
            held = self.line[(past + 1 - RATIO) % len(self.line), np.arange(len(past))]
            sampled = np.where(past + 1 - RATIO >= 0, held, 0.0)
            moved = np.where(self.slow, RATIO * self.model.increment(sampled) if due else 0.0, moved)
        self.angle = np.clip(before + moved, self.model.lower_deg, self.model.upper_deg)
        self.k += 1
        return before


def measures(angles: Array, target: float) -> Array:
    """Rise time [s] and overshoot [%] of each form, against set point and final value, shape (2, 2, n)."""
    found = []
    for end in (np.full(angles.shape[1], target), angles[-1]):
        share = angles / np.where(end == 0.0, np.nan, end)
        times = []
        for level in (0.1, 0.9):
            above = share >= level
            k = above.argmax(axis=0)
            columns = np.arange(len(k))
            upper, lower = share[k, columns], share[np.maximum(k - 1, 0), columns]
            with np.errstate(divide="ignore", invalid="ignore"):
                part = np.where(k > 0, (level - lower) / (upper - lower), 1.0)
            times.append(np.where(above.any(axis=0), (k - 1 + part) * MODEL_S, np.nan))
        peak = np.nanmax(np.where(np.isfinite(share), share, -np.inf), axis=0)
        found.append([times[1] - times[0], np.maximum(0.0, 100.0 * (peak - 1.0))])
    return np.array(found)


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
    longest = max(len(form["den"]) for form in forms)  # type: ignore[arg-type]
    den = np.array([np.pad(form["den"], (0, longest - len(form["den"]))) for form in forms]).T  # type: ignore[arg-type]
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


def misses(found: Array, controller: str, joint: str) -> Array:
    """How far rise time and overshoot are off, in what counts as reproduced, the larger of both, shape (2, n)."""
    table = STEP_TABLES[controller]
    rise = np.abs(found[:, 0] - table["rise_s"][joint]) / RISE_S
    over = np.abs(found[:, 1] - table["overshoot_percent"][joint]) / OVERSHOOT
    return np.nan_to_num(np.maximum(rise, over), nan=np.inf)


def said(form: Form) -> str:
    """A form in words."""
    return ", ".join(f"{key} {value}" for key, value in form.items() if key not in ("den", "k_i", "k_p"))


def cell(found: Array, measure: int, n: int) -> str:
    """Rise time and overshoot."""
    return f"{found[measure, 0, n]:.3f} s, {found[measure, 1, n]:.1f} %"


def printed(controller: str, joint: str) -> str:
    """What the thesis prints."""
    table = STEP_TABLES[controller]
    return f"{table['rise_s'][joint]:.3f} s, {table['overshoot_percent'][joint]:.1f} %"


def row(*cells: object) -> None:
    """One row of a table."""
    print(f"| {' | '.join(map(str, cells))} |", flush=True)


def head(*titles: str) -> None:
    """The head of a table."""
    print()
    row(*titles)
    row(*["---"] * len(titles))


def searched_forward(joint: str, tuning: str) -> tuple[list[Form], Array]:
    """All forms of one case, and what they measure."""
    forms = forward_forms(joint, tuning)
    laws = dict.fromkeys((form["law"], form["inverse"]) for form in forms)
    parts = [[form for form in forms if (form["law"], form["inverse"]) == law] for law in laws]
    return [form for part in parts for form in part], np.concatenate(
        [run_forward(joint, part) for part in parts], axis=2
    )


def forward_path() -> None:
    """The tables of the forward path."""
    found = {(joint, tuning): searched_forward(joint, tuning) for joint in JOINTS for tuning in "abc"}
    print(f"{sum(len(forms) for forms, _ in found.values())} simulations")
    head(
        "case",
        "printed",
        f"form used, {MEASURES[0]}",
        f"form used, {MEASURES[1]}",
        "nearest of all forms",
        "which",
    )
    for (joint, tuning), (forms, values) in found.items():
        used = {**USED, "direction": DIRECTION[joint]}
        n = next(n for n, form in enumerate(forms) if used.items() <= form.items())
        off = misses(values, f"pip_forward_{tuning}", joint)
        m, best = (int(i) for i in np.unravel_index(int(off.argmin()), off.shape))
        different = {key: forms[best][key] for key in used if forms[best][key] != used[key]}
        row(
            joint + tuning, printed(f"pip_forward_{tuning}", joint), cell(values, 0, n), cell(values, 1, n),
            f"{cell(values, m, best)} ({off.min():.1f})", f"{said(different) or 'the form used'}; {MEASURES[m]}",
        )  # fmt: skip
    head(
        "joint", "forms for all three tunings", "worst of rise times and overshoots", "a", "b", "c", "nearest"
    )
    for joint in JOINTS:
        forms = found[joint, "a"][0]
        off = np.maximum.reduce([misses(found[joint, t][1], f"pip_forward_{t}", joint) for t in "abc"])
        m, best = (int(i) for i in np.unravel_index(int(off.argmin()), off.shape))
        used = {**USED, "direction": DIRECTION[joint]}
        different = {key: forms[best][key] for key in used if forms[best][key] != used[key]}
        cells = [cell(found[joint, t][1], m, best) for t in "abc"]
        row(
            joint,
            len(forms),
            f"{off.min():.2f}",
            *cells,
            f"{said(different) or 'the form used'}; {MEASURES[m]}",
        )


def pi() -> None:
    """The tables of PI."""
    found = {}
    for joint in JOINTS:
        gains = tuple(map(float, entry("pi", joint)))
        found[joint] = {ratio: run_pi(joint, pi_forms([gains]), ratio) for ratio in (RATIO, 1)}
    forms = pi_forms([(0.0, 0.0)])
    head("joint", "printed", f"nearest of {2 * len(forms)} forms", "which")
    for joint in JOINTS:
        off = np.array([misses(values, "pi", joint) for values in found[joint].values()])
        r, m, n = (int(i) for i in np.unravel_index(int(off.argmin()), off.shape))
        ratio = (RATIO, 1)[r]
        row(
            joint, printed("pi", joint), f"{cell(found[joint][ratio], m, n)} ({off.min():.1f})",
            f"{said(forms[n])}, every {ratio * MODEL_S:g} s; {MEASURES[m]}",
        )  # fmt: skip
    head("joint", "printed", "nearest with other gains, the form used", "K_P, K_I", "which")
    levels = np.concatenate([np.arange(0.0, 2.0, 0.05), np.arange(2.0, 12.0, 0.5)])
    for joint in JOINTS:
        forms = [
            {**USED_PI, "k_p": k_p, "k_i": k_i, "(6.8)": limited, "direction": DIRECTION[joint]}
            for k_p, k_i, limited in itertools.product(np.arange(0.5, 12.0, 0.1), levels, (True, False))
        ]
        values = run_pi(joint, forms)
        off = misses(values, "pi", joint)
        m, n = (int(i) for i in np.unravel_index(int(off.argmin()), off.shape))
        form = forms[n]
        row(
            joint, printed("pi", joint), f"{cell(values, m, n)} ({off.min():.1f})",
            f"{form['k_p']:.2f}, {form['k_i']:.2f}",
            f"{'with' if form['(6.8)'] else 'without'} (6.8); {MEASURES[m]}",
        )  # fmt: skip


def main() -> None:
    """Run the search."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("which", nargs="*", default=["forward", "pi"])
    which = parser.parse_args().which
    if "forward" in which:
        forward_path()
    if "pi" in which:
        pi()


if __name__ == "__main__":
    main()
