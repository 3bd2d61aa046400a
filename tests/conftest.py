"""Order of the tests."""

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Groups that stay together come first: they take long, and at the end one worker would wait for the other."""
    items.sort(key=lambda item: item.get_closest_marker("xdist_group") is None)
