"""Fuzzy control with one and with two inputs, section 7.1 and appendix F, evaluated as a precomputed surface."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from hydrolek_drake.control.laws.law import Array, InputElement, WithoutState
from hydrolek_drake.control.laws.scaled_input import ScaledInput
from hydrolek_drake.yaml_files import package_yaml

SETS = ("NB", "N", "Z", "P", "PB")
_POINTS = 1041  # of the output's universe in the centroid


@cache
def fuzzy_data() -> dict[str, Any]:
    """Content of `fuzzy.yaml`."""
    return package_yaml(__package__, "fuzzy.yaml")


def membership(value: Array, corners: Sequence[float]) -> Array:
    """Degree of membership of a trapezoid with given corners, 0 to 1; feet at infinity are open shoulders."""
    a, b, c, d = corners
    rising = np.ones_like(value) if np.isinf(b) else np.clip((value - a) / max(b - a, 1e-300), 0.0, 1.0)
    falling = np.ones_like(value) if np.isinf(c) else np.clip((d - value) / max(d - c, 1e-300), 0.0, 1.0)
    return np.minimum(rising, falling)


def infer(strengths: Mapping[str, Array], outputs: Mapping[str, Sequence[float]]) -> Array:
    """Mamdani inference: sets cut at their rules' strengths, joined by maximum, centroid of the area.

    Args:
        strengths: of each output set, shape (n,).
        outputs: corners of the output sets.

    Returns:
        Shape (n,); 0 where no rule fires.
    """
    farthest = max(-outputs["NB"][0], outputs["PB"][3])
    universe = np.linspace(-farthest, farthest, _POINTS)  # even about 0, so that Z alone gives 0 exactly
    shape = np.zeros((len(next(iter(strengths.values()))), _POINTS))
    for name, strength in strengths.items():
        cut = np.minimum(membership(universe, outputs[name]), np.asarray(strength)[:, np.newaxis])
        np.maximum(shape, cut, out=shape)
    area = shape.sum(axis=1)
    return np.where(area > 0.0, shape @ universe / np.maximum(area, np.finfo(float).tiny), 0.0)


def single_input_surface(data: Mapping[str, Any]) -> tuple[Array, Array]:
    """Errors [deg] and outputs of the five rules."""
    errors = _axis(data["error"], data["grid"]["error"])
    strengths = {data["single"][name]: membership(errors, data["error"][name]) for name in SETS}
    return errors, infer(strengths, data["output"])


def two_input_surface(
    sets: Mapping[str, Any], rules: Mapping[str, Sequence[str]], *, error_sign: float = 1.0
) -> tuple[Array, Array, Array]:
    """Errors [deg], changes [deg per sample] and outputs (errors, changes) of 25 rules.

    A rule fires as strongly as the weaker of its two conditions.

    Args:
        sets: "error", "change", "output" and "grid", as in `fuzzy.yaml`.
        rules: error set -> output set for each set of the change.
        error_sign: -1 for rules that are written for angle less set point; the grid is set point less angle.
    """
    errors = _axis(sets["error"], sets["grid"]["error"])
    changes = _axis(sets["change"], sets["grid"]["change"])
    of_change = {name: membership(error_sign * changes, sets["change"][name]) for name in SETS}
    surface = np.empty((len(errors), len(changes)))
    for i, error in enumerate(error_sign * errors):
        strengths = {name: np.zeros(len(changes)) for name in SETS}
        for row in SETS:
            of_error = float(membership(np.array(error), sets["error"][row]))
            for column, consequence in zip(SETS, rules[row], strict=True):
                fired = np.minimum(of_error, of_change[column])
                strengths[consequence] = np.maximum(strengths[consequence], fired)
        surface[i] = infer(strengths, sets["output"])
    return errors, changes, surface


def _axis(sets: Mapping[str, Sequence[float]], count: int) -> Array:
    return np.linspace(sets["NB"][2], sets["PB"][1], count)


@cache
def _single() -> tuple[Array, Array]:
    return single_input_surface(fuzzy_data())


@cache
def _double() -> tuple[Array, Array, Array]:
    return two_input_surface(fuzzy_data(), fuzzy_data()["two_input"])


@cache
def printed_surface() -> tuple[Array, Array, Array]:
    """Table 7.1's rules with the sets of `fuzzy_double`, in the sign that closes the loop."""
    return two_input_surface(fuzzy_data(), fuzzy_data()["table_7_1"], error_sign=-1.0)


def appendix_f_sets(scaling: ScaledInput, joint: str) -> dict[str, Any]:
    """Sets of one joint in the form of appendix F: its output sets are voltages, placed by the joint's own scaling.

    The thesis shows its sets as pictures only. Here an output set's corners are parts of the way from the edge of
    the dead-zone to the highest voltage of Table 6.3, D + part (S - D); Z reaches to a part of D.

    Args:
        scaling: of the joint.
        joint: "j1" to "j4", whose parts are taken.
    """
    form = fuzzy_data()["appendix_f"]
    below, above = scaling.dead_negative_V, scaling.dead_positive_V
    lowest, highest = scaling.lowest_V, scaling.highest_V
    slow, fast = form["slow"][joint], form["fast"]
    shut = form["shut"] * min(-below, above)
    return {
        "grid": fuzzy_data()["grid"],
        "error": form["error"],
        "change": form["change"],
        "output": {
            "NB": [below + part * (lowest - below) for part in reversed(fast)],
            "N": [below + part * (lowest - below) for part in reversed(slow)],
            "Z": [-shut, 0.0, 0.0, shut],
            "P": [above + part * (highest - above) for part in slow],
            "PB": [above + part * (highest - above) for part in fast],
        },
    }


@cache
def appendix_f_surface(scaling: ScaledInput, joint: str) -> tuple[Array, Array, Array]:
    """Table 7.1's rules with a joint's sets of `appendix_f_sets`; outputs are voltages."""
    return two_input_surface(appendix_f_sets(scaling, joint), fuzzy_data()["table_7_1"], error_sign=-1.0)


@dataclass(frozen=True)
class SingleInputFuzzyLaw(WithoutState):
    """Error to output by five rules, section 7.1.1.

    Attributes:
        element: output [deg per sample] to voltage.
        errors: grid of the precomputed curve [deg].
        outputs: on the grid.
    """

    element: InputElement
    errors: Array = field(default_factory=lambda: _single()[0])
    outputs: Array = field(default_factory=lambda: _single()[1])

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`."""
        output = float(np.interp(set_point_deg - measured_deg, self.errors, self.outputs))
        return state.copy(), output, self.element.voltage(output)


@dataclass(frozen=True)
class TwoInputFuzzyLaw:
    """Error and change of error to output by 25 rules, section 7.1.2.

    Table 7.1 cannot be used with the error that section 6.2.1 defines, e = set point - angle: it answers a
    positive error with a negative voltage. With e = angle - set point it closes the loop, but does not brake:
    its middle row is Z whatever the change, and joint and set point may pass each other at full speed. It is
    also lopsided: (P, P) gives NB where its mirror image (N, N) gives P. The rules used here have the same
    sets, are symmetric, and brake (docs/guides/control.md). `printed_surface` and `appendix_f_surface` give the table
    as it is printed.

    Attributes:
        element: output to voltage.
        errors: grid of the precomputed surface [deg].
        changes: grid [deg per sample].
        surface: outputs [deg per sample, or V in the form of appendix F], shape (errors, changes).
    """

    element: InputElement
    errors: Array = field(default_factory=lambda: _double()[0])
    changes: Array = field(default_factory=lambda: _double()[1])
    surface: Array = field(default_factory=lambda: _double()[2])

    @property
    def size(self) -> int:
        """The last error, and whether there was one."""
        return 2

    def initial(self, measured_deg: float) -> Array:
        """No error yet."""
        return np.zeros(2)

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`; the surface is interpolated linearly in both inputs."""
        error = set_point_deg - measured_deg
        change = error - float(state[0]) if state[1] else 0.0
        i, share_i = _cell(self.errors, error)
        j, share_j = _cell(self.changes, change)
        low = (1.0 - share_j) * self.surface[i, j] + share_j * self.surface[i, j + 1]
        high = (1.0 - share_j) * self.surface[i + 1, j] + share_j * self.surface[i + 1, j + 1]
        output = float((1.0 - share_i) * low + share_i * high)
        return np.array([error, 1.0]), output, self.element.voltage(output)


def _cell(axis: Array, value: float) -> tuple[int, float]:
    """Index of the grid cell that holds `value`, and how far along it lies; clipped to the grid."""
    place = (min(max(value, axis[0]), axis[-1]) - axis[0]) / (axis[1] - axis[0])
    index = min(int(place), len(axis) - 2)
    return index, float(place - index)
