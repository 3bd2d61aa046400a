"""What an effect is told by where the machine's own numbers make nearly all that it changes."""

import numpy as np
import pytest

from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.identification.parameter_set import Free
from hydrolek_drake.watching.fitting.scanning import _faint, _scan, at_size, strength

LEAKAGE = EFFECTS["cylinder.cross_port_leakage"]
PATH = f"joints.joint.effects.{LEAKAGE.id}.{LEAKAGE.size}"
SIZES = (1e-14, 1e-13)
PLANTED = 4e-14
DEVIATION = 4e-15
"""Of a size of the leakage, beside own numbers."""


def _leakage():
    free = (Free(PATH, 0.0, 5e-12),)
    return Candidate(LEAKAGE, "joint", free, tuple({PATH: size} for size in SIZES), {})


def _changes(rng, values=500):
    """Directions of residuals: made by own numbers, left across them, and that in which own numbers bend."""
    made, left, bent = np.linalg.qr(rng.standard_normal((values, 3)))[0].T

    def change(size):
        linear = size / DEVIATION * left
        return 50.0 * size / DEVIATION * made + linear + 10.0 * (size / DEVIATION) ** 2 * bent

    def across(vector):
        return vector - made * (made @ vector)

    return change, across, left


def test_an_effect_that_own_numbers_bend_for_is_told_by_its_slope():
    """At the sizes that are tried first, what is left of it is a thousand times as large as the effect leaves."""
    rng = np.random.default_rng(4)
    change, across, left = _changes(rng)
    candidate, starts = _leakage(), [{PATH: size} for size in SIZES]
    faint = _faint(candidate, starts, [change(size) for size in SIZES])
    assert [np.linalg.norm(change(start[PATH])) for start in faint] == pytest.approx([1.0], abs=0.5)
    tried = [*starts, *faint]
    changes = [change(start[PATH]) for start in tried]
    residuals = across(rng.standard_normal(left.size) - PLANTED / DEVIATION * left)
    scan = _scan(candidate, tried, changes, [across(each) for each in changes], residuals)
    told = strength(candidate, scan.start[PATH])
    assert abs(told - PLANTED) < 3.0 * DEVIATION
    assert scan.deviation == pytest.approx(DEVIATION, rel=0.1)
    assert scan.gain > 40.0  # ten standard deviations
    coarse = [across(each) for each in changes[: len(SIZES)]]
    without = _scan(candidate, starts, changes[: len(SIZES)], coarse, residuals)
    assert without.gain < 4.0  # which would tell it as nothing


def test_what_has_the_unit_of_a_size_goes_with_it():
    effect = EFFECTS["cylinder.stribeck_friction"]
    base = f"joints.joint.effects.{effect.id}."
    names = ("coulomb_N", "stribeck_N", "stribeck_velocity_m_per_s")
    values = dict(zip((base + name for name in names), (50.0, 100.0, 0.01), strict=True))
    free = tuple(Free(path, 0.0, 1e4) for path in values)
    friction = Candidate(effect, "joint", free, (values,), {})
    smaller = at_size(friction, values, 0.1 * values[friction.size_path])
    assert list(smaller.values()) == pytest.approx([5.0, 10.0, 0.01])
