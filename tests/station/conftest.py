"""Scenario files of the tests."""

import pytest


@pytest.fixture
def scenario_file(tmp_path):
    """A function: text -> the scenario file that holds it."""

    def write(text):
        path = tmp_path / "mine.yaml"
        path.write_text(text)
        return path

    return write
