#!/usr/bin/env python3
"""Which form of the forward path and of PI gives the thesis's Tables G.3 and G.4?

Every form of a family is simulated on the SDP models (6.2), (6.3), (6.20), many at a time, for the steps of appendix G,
and judged by the printed rise time and overshoot, each measured against the set point and against the final value, as
MATLAB's `stepinfo` does. Prints the tables of docs/evidence/control.md; in brackets how far a form is off, in what
counts as reproduced (0.03 s, 1.5 points).
"""

import argparse
import itertools

import numpy as np
from thesis_forms.forward_path import USED, forward_forms, run_forward
from thesis_forms.pi import USED_PI, pi_forms, run_pi
from thesis_forms.plants import MODEL_S, RATIO, Array, Form

from hydrolek_drake.control.comparison.thesis_tables import STEP_TABLES
from hydrolek_drake.control.thesis_gains import entry

JOINTS = ("j1", "j2", "j3", "j4")
RISE_S, OVERSHOOT = 0.03, 1.5  # what counts as reproduced, as for the feedback form (tests/control)
MEASURES = ("set point", "final value")

DIRECTION = {"j1": 1, "j2": 1, "j3": -1, "j4": 1}
"""Of the steps, by which the feedback forms reproduce."""


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
