"""Which tests run with each change, and which with `--all` alone."""

import pytest


def _asked_for_all(config: pytest.Config) -> bool:
    return config.getoption("--all") or config.getoption("--long")


@pytest.mark.thorough
def test_a_thorough_test_runs_only_when_all_are_asked_for(request: pytest.FixtureRequest) -> None:
    assert _asked_for_all(request.config)


@pytest.mark.thorough(but=1)
@pytest.mark.parametrize("case", ["first", "second"])
def test_so_many_cases_run_with_each_change(request: pytest.FixtureRequest, case: str) -> None:
    assert case == "first" or _asked_for_all(request.config)


@pytest.mark.thorough(but=("second",))
@pytest.mark.parametrize("case", ["first", "second"])
def test_named_cases_run_with_each_change(request: pytest.FixtureRequest, case: str) -> None:
    assert case == "second" or _asked_for_all(request.config)


@pytest.mark.long("never: it fails")
@pytest.mark.skipif("config.getoption('--long')", reason="it fails")
def test_a_long_test_is_not_among_all() -> None:
    pytest.fail("it ran without --long")
