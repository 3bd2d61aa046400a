"""Order of the tests, and a rig of which several folders have need."""

import pytest

from hydrolek_drake.rigs import Rig, load_rig

MOVING = ("right_j2", "right_j3")


@pytest.fixture(scope="session")
def two_joints(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    """The right arm with two joints that move and the others held."""
    path = tmp_path_factory.mktemp("rig") / "two_joints.yaml"
    path.write_text(
        f"schema: 1\nname: two_joints\nbased_on: hydrolek\nkeep: [{', '.join(MOVING)}]\ntitle: two joints\n"
    )
    return load_rig(path, {})


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Groups that stay together come first: they take long, and at the end one worker would wait for the other."""
    items.sort(key=lambda item: item.get_closest_marker("xdist_group") is None)
