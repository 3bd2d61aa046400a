"""A law in a rig file is checked key by key."""

import copy

import pytest
import yaml

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig

M = {"unit": "m", "source": "test"}
TERM = {
    "enters": "cylinder",
    "factors": {"place": "z", "speed": "sign(v)"},
    "seen": "rod",
    "sine": {"value": 0.31, "unit": "kN", "source": "test"},
    "low": {"value": 0.0, **M},
    "high": {"value": 0.15, **M},
    "speed": {"value": 0.1, "unit": "m/s", "source": "test"},
    "slow": {"value": 2.0, "unit": "mm/s", "source": "test"},
    "seconds": {"value": 40.0, "unit": "s", "source": "test"},
    "opening": {"value": 0.5, "unit": "mm", "source": "test"},
    "pressure": {"value": 16.0, "unit": "MPa", "source": "test"},
}


def _rig(tmp_path, law):
    path = tmp_path / "mine.yaml"
    path.write_text(
        yaml.safe_dump({"schema": 1, "based_on": "joint_bench", "joints": {"joint": {"law": law}}})
    )
    return load_rig(path, {})


def test_a_law_is_read_in_si(tmp_path) -> None:
    (term,) = _rig(tmp_path, [TERM]).laws["joint"]
    assert term.numbers["sine"].value == pytest.approx(310.0)
    assert term.numbers["slow"].value == pytest.approx(2e-3)
    record = _rig(tmp_path, [TERM]).records()[0]["law"]["term_1"]
    assert record["sine"] == pytest.approx(310.0) and record["at_rod"] == 1.0
    assert record["frequency"] == 0.0
    assert load_rig("joint_bench", {}).laws == {}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"enters": "pump"}, "law[1].enters 'pump' is unknown; choose command, amplifier, valve, supply"),
        ({"enters": None}, "law[1].enters is missing"),
        ({"factors": {"place": "z^3"}}, "law[1].factors.place 'z^3' is unknown; choose 1, z, z^2"),
        ({"factors": {"plaice": "z"}}, "did you mean place?"),
        ({"seen": "valve"}, "law[1].seen 'valve' is unknown; choose joint, rod"),
        ({"sine": None}, "law[1].sine: 'None' is not a parameter"),
        ({"sine": {"value": 1.0, "unit": "Pa", "source": "test"}}, "does not measure what is wanted"),
        ({"slow": {"value": 0.0, "unit": "m/s", "source": "test"}}, "must be above zero"),
        ({"high": {"value": -1.0, **M}}, "law[1].low must be smaller"),
        ({"strength": 1.0}, "law[1].strength: unknown key"),
    ],
)
def test_a_wrong_law_is_refused_with_one_line(tmp_path, change, says) -> None:
    with pytest.raises(InputError) as refused:
        _rig(tmp_path, [{**copy.deepcopy(TERM), **change}])
    assert says in str(refused.value) and "\n" not in str(refused.value)
    assert "mine.yaml" in str(refused.value)


@pytest.mark.parametrize("law", [{}, "friction", [], [TERM] * 7])
def test_a_law_is_a_list_of_a_few_terms(tmp_path, law) -> None:
    with pytest.raises(InputError, match="must be a list of 1 to 6 terms"):
        _rig(tmp_path, law)


@pytest.mark.parametrize(
    ("factors", "needs"),
    [
        ({}, ["sine"]),
        ({"time": "t/T"}, ["sine", "seconds"]),
        ({"place": "z^2", "speed": "sign(v)"}, ["sine", "low", "high", "slow"]),
        ({"speed": "v |v|"}, ["sine", "speed"]),
        ({"other": "(p_A - p_B)"}, ["sine", "pressure"]),
        ({"other": "|x|"}, ["sine", "opening"]),
    ],
)
def test_a_term_states_the_numbers_of_its_factors_and_no_others(tmp_path, factors, needs) -> None:
    few = {"enters": "load", "factors": factors, **{name: TERM[name] for name in needs}}
    few["sine"] = {"value": 5.0, "unit": "N m", "source": "test"}
    (term,) = _rig(tmp_path, [few]).laws["joint"]
    assert set(term.numbers) == set(needs)
    for name in needs:
        short = {key: value for key, value in few.items() if key != name}
        with pytest.raises(InputError, match=rf"law\[1\].{name} is missing: .* \["):
            _rig(tmp_path, [short])
