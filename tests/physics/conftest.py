"""Records of built-in rigs with other values, for functions that take a joint's parameters."""

import pytest

from hydrolek_drake.rigs import load_rig


@pytest.fixture(scope="session")
def bench():
    """The rig joint_bench."""
    return load_rig("joint_bench")


@pytest.fixture(scope="session")
def bench_joint(bench):
    """A function: values by path (SI) -> the bench's parameter record with them."""

    def make(values=None):
        return bench.with_values(values or {}).records()[0]

    return make


@pytest.fixture(scope="session")
def crane_joint():
    """The record of a rig with a pressure-compensated valve."""
    return load_rig("patu_lift").records()[0]


@pytest.fixture(scope="session")
def slide_joint():
    """A function: values by path (SI) -> record of a cylinder that moves a slide directly."""
    rig = load_rig("festo_tp511")

    def make(values=None):
        return rig.with_values(values or {}).records()[0]

    return make


@pytest.fixture(scope="session")
def link_joint():
    """A function: values by path (SI) -> record of a joint with four edges and a pump."""
    rig = load_rig("hopsan_link")

    def make(values=None):
        return rig.with_values(values or {}).records()[0]

    return make
