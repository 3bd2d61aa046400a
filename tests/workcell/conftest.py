"""Collision worlds, which take a third of a second each to build."""

import pytest

from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.pipe import make_pipe


@pytest.fixture(scope="package")
def pipe():
    return make_pipe()


@pytest.fixture(scope="package")
def clear(pipe):
    return CollisionWorld(pipe)


@pytest.fixture(scope="package")
def holding(pipe):
    return CollisionWorld(pipe, padding=0.0, holding=("right",))
