"""Order of the tests, which of them run, and what several folders need: a browser, joints that move together."""

import contextlib
import os
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.linear_algebra import in_one_thread
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rollout.lanes import compiling as lane_compiling
from hydrolek_drake.rollout.together.together import JointsTogether

in_one_thread()  # tests run side by side
lane_compiling.WORTH = lane_compiling.WORTH_TOGETHER = 10**9  # nothing is compiled beside them for later runs

MOVING = ("right_j2", "right_j3")


@pytest.fixture(scope="session")
def two_joints(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    """The right arm with two joints that move and the others held."""
    path = tmp_path_factory.mktemp("rig") / "two_joints.yaml"
    path.write_text(
        f"schema: 1\nname: two_joints\nbased_on: hydrolek\nkeep: [{', '.join(MOVING)}]\ntitle: two joints\n"
    )
    return load_rig(path, {})


@pytest.fixture(scope="session")
def recorded_together() -> Callable[..., tuple[Recording, np.ndarray]]:
    """(machine, seed, seconds, largest volts, noise, its seed, name) -> recording of both joints, and what they read.

    Each joint has its own random steps of half a second. What is read is without noise [rad]. # (n, 2)
    """

    def make(
        machine: Rig,
        seed: int = 4,
        seconds: float = 8.0,
        largest_V: float = 3.0,
        noise_deg: float = 0.05,
        noise_seed: int = 0,
        name: str = "made",
    ) -> tuple[Recording, np.ndarray]:
        time = np.arange(0.0, seconds + 0.005, 0.01)
        levels = np.random.default_rng(seed).uniform(-largest_V, largest_V, (round(2 * seconds) + 1, 2))
        volts = np.repeat(levels, 50, axis=0)[: time.size]
        volts[:50] = 0.0
        records = machine.records()
        starts = records["load"]["initial_position"][[machine.joints.index(joint) for joint in MOVING]]
        done = JointsTogether(machine, MOVING).roll_out(records, time, volts, time, starts, 2.5e-4)
        reading = done.signals["reading"]
        noise = np.random.default_rng((seed, noise_seed)).standard_normal(reading.shape)
        noisy = reading + np.radians(noise_deg) * noise
        signals = {f"{joint}.command": volts[:, i] for i, joint in enumerate(MOVING)}
        signals |= {f"{joint}.angle": noisy[:, i] for i, joint in enumerate(MOVING)}
        signals["supply.pressure"] = done.signals["supply_pressure"][:, 0]
        return Recording(name, time, signals, Path(f"{name}.csv")), reading

    return make


def pytest_addoption(parser: pytest.Parser) -> None:
    """Tests that take long are wanted now and then, and not with every change."""
    parser.addoption("--all", action="store_true", help="also run the tests that are marked thorough")
    parser.addoption("--long", action="store_true", help="run all of these, and those that are marked long")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Thorough and long tests are skipped unless they are asked for.

    Groups that stay together come first: they take long, and at the end one worker would wait for the other.
    """
    items.sort(key=lambda item: item.get_closest_marker("xdist_group") is None)
    if config.getoption("--long"):
        return
    cases: Counter[str] = Counter()
    for item in items:
        name = item.nodeid.partition("[")[0]
        cases[name] += 1
        if (marker := item.get_closest_marker("long")) is not None:
            item.add_marker(pytest.mark.skip(reason=f"{marker.args[0]}: --long"))
        elif not config.getoption("--all") and _is_thorough(item, cases[name]):
            item.add_marker(pytest.mark.skip(reason="of the second tier: --all"))


def _is_thorough(item: pytest.Item, number: int) -> bool:
    """Whether a test is marked so and is none of the cases that the mark leaves to each change.

    Args:
        item: the test.
        number: of the case, among those of the test.
    """
    if (marker := item.get_closest_marker("thorough")) is None:
        return False
    but = marker.kwargs.get("but", 0)
    return number > but if isinstance(but, int) else item.callspec.id not in but


@pytest.fixture
def cluster():
    """A Dask cluster of two processes on this computer."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as made:
        yield made


@pytest.fixture
def chromium_page() -> Iterator:
    """A page of a real browser 390 pixels wide; a test that asks for it is skipped where there is none."""
    engine = pytest.importorskip(
        "playwright.sync_api", reason="Playwright drives the browser: pip install playwright"
    )
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if found is None:
        pytest.skip("there is no chromium, chromium-browser or google-chrome on the search path")
    options = ["--disable-gpu", *(["--no-sandbox"] if os.geteuid() == 0 else [])]
    with (
        engine.sync_playwright() as playwright,
        contextlib.closing(playwright.chromium.launch(executable_path=found, args=options)) as browser,
    ):
        yield browser.new_page(viewport={"width": 390, "height": 844})
