"""Order of the tests, which of them run, and a rig of which several folders have need."""

import pytest

from hydrolek_drake.linear_algebra import in_one_thread
from hydrolek_drake.rigs import Rig, load_rig

in_one_thread()  # tests run side by side

MOVING = ("right_j2", "right_j3")


@pytest.fixture(scope="session")
def two_joints(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    """The right arm with two joints that move and the others held."""
    path = tmp_path_factory.mktemp("rig") / "two_joints.yaml"
    path.write_text(
        f"schema: 1\nname: two_joints\nbased_on: hydrolek\nkeep: [{', '.join(MOVING)}]\ntitle: two joints\n"
    )
    return load_rig(path, {})


def pytest_addoption(parser: pytest.Parser) -> None:
    """Tests that take long are wanted now and then, and not with every change."""
    parser.addoption("--long", action="store_true", help="also run the tests that are marked long")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Long tests are skipped unless they are asked for.

    Groups that stay together come first: they take long, and at the end one worker would wait for the other.
    """
    items.sort(key=lambda item: item.get_closest_marker("xdist_group") is None)
    if config.getoption("--long"):
        return
    for item in items:
        if (marker := item.get_closest_marker("long")) is not None:
            item.add_marker(pytest.mark.skip(reason=f"{marker.args[0]}: --long"))
