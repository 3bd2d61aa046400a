"""The map between unit cube and rig, and what it refuses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.parameter_set import Free, ParameterSet, free_parameters, parameters_off
from hydrolek_drake.rigs import load_rig


@given(st.floats(0.0, 1.0), st.booleans())
def test_place_and_value_invert_each_other(u: float, log: bool) -> None:
    free = Free("x", 2.0, 50.0, log)
    assert free.to_unit(free.from_unit(u)) == pytest.approx(u, abs=1e-12)


def test_slope_is_the_derivative_of_the_value() -> None:
    for log in (False, True):
        free = Free("x", 2.0, 50.0, log)
        numeric = (free.from_unit(0.3 + 1e-6) - free.from_unit(0.3 - 1e-6)) / 2e-6
        assert free.slope(0.3) == pytest.approx(numeric, rel=1e-6)


def test_records_equal_those_of_the_rig_with_these_values() -> None:
    rig = load_rig("joint_bench", {})
    parameters = ParameterSet(rig, free_parameters(rig))
    unit = np.linspace(0.05, 0.95, len(parameters))
    records = parameters.records(unit)
    assert records.tobytes() == _followed(rig, parameters.values(unit)).tobytes()


def _followed(rig, values):
    """The rig's records with these values, and those that follow them set alike."""
    more = dict(values)
    for path, entry in rig.entries.items():
        section, _, _ = path.rpartition(".")
        if entry.same_as is not None and f"{section}.{entry.same_as}" in values:
            more[path] = values[f"{section}.{entry.same_as}"]
    return rig.with_values(more).records()


def test_a_supply_parameter_reaches_every_joint() -> None:
    rig = load_rig("hydrolek", {})
    path = next(p for p in rig.free_parameters() if p.startswith("supply."))
    parameters = ParameterSet(rig, free_parameters(rig, [path]))
    records = parameters.records(np.array([0.75]))
    value = parameters.values(np.array([0.75]))[path]
    assert set(records["supply"][path.split(".")[1]].tolist()) == {value}


def test_what_cannot_be_fitted_is_refused() -> None:
    rig = load_rig("joint_bench", {})
    with pytest.raises(InputError, match="has no range"):
        free_parameters(rig, ["fluid.density"])
    with pytest.raises(InputError, match="no parameter"):
        free_parameters(rig, ["cylinder.colour"])
    with pytest.raises(InputError, match="is empty or has no end"):
        Free("x", 2.0, 2.0)
    with pytest.raises(InputError, match="above zero"):
        Free("x", 0.0, 1.0, log=True)
    with pytest.raises(InputError, match="beyond what is possible"):
        ParameterSet(rig, [Free(rig.full_path("load.inertia"), -1.0, 5.0)])


def test_an_effect_that_is_off_is_fitted_only_if_it_is_named() -> None:
    rig = load_rig("emps_published", {})
    drift = "joints.axis.effects.sensor.drift.rate_rad_per_min"
    assert drift in parameters_off(rig)
    assert drift not in {free.path for free in free_parameters(rig)}
    assert [free.path for free in free_parameters(rig, [drift])] == [drift]
    switched_on = rig.with_values({drift: 1e-7})
    assert drift not in parameters_off(switched_on)
    assert drift in {free.path for free in free_parameters(switched_on)}
