"""Tests that share what takes long to make run in one process: otherwise each process makes it anew."""

import os

import pytest


@pytest.mark.xdist_group("kept together")
@pytest.mark.skipif("PYTEST_XDIST_WORKER" not in os.environ, reason="tests run in one process")
def test_a_test_of_a_group_is_known_as_such_to_the_distribution(request: pytest.FixtureRequest) -> None:
    assert request.node.nodeid.endswith("@kept together")
