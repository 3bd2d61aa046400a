"""Data that cannot be diagnosed are refused with the reason."""

from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis.structures.splitting import reasons_against
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.recordings import Recording, read_recording

TIME = np.arange(0.0, 20.0, 0.01)


def _reasons(bench, angle, time=TIME):
    command = np.where(np.sin(time) > 0.0, 4.0, -4.0)
    recording = Recording("bad", time, {"joint.command": command, "joint.angle": angle}, Path("bad.csv"))
    return " ".join(reasons_against(recording, experiments_of(bench, recording)))


def _moving(seed: int = 1) -> np.ndarray:
    return 0.4 + 0.3 * np.sin(TIME) + 1e-3 * np.random.default_rng(seed).standard_normal(TIME.size)


def test_good_data_have_nothing_against_them(bench) -> None:
    assert _reasons(bench, _moving()) == ""


def test_all_practice_recordings_are_usable(bench) -> None:
    for path in sorted((Path(__file__).parents[2] / "data" / "bench").glob("*/train.csv")):
        recording = read_recording(path, bench.columns)
        assert reasons_against(recording, experiments_of(bench, recording)) == []


def test_a_joint_that_does_not_move(bench) -> None:
    still = 0.4 + 1e-3 * np.random.default_rng(1).standard_normal(TIME.size)
    assert "hardly moves" in _reasons(bench, still)


def test_a_sensor_that_has_frozen(bench) -> None:
    angle = _moving()
    angle[800:] = angle[800]
    assert "frozen" in _reasons(bench, angle)


def test_a_sensor_with_gaps(bench) -> None:
    angle = _moving()
    angle[500:1300] = np.nan
    assert "no value in 40 %" in _reasons(bench, angle)


def test_too_few_samples(bench) -> None:
    few = slice(0, 150)
    assert "at least 200" in _reasons(bench, _moving()[few], TIME[few])


@pytest.mark.parametrize("word", ["constant"])
def test_a_command_that_never_changes_is_bad_data(bench, word: str) -> None:
    from concurrent.futures import ThreadPoolExecutor

    from hydrolek_drake.diagnosis.diagnosis import diagnose

    recording = Recording(
        "flat", TIME, {"joint.command": np.full(TIME.size, 3.0), "joint.angle": _moving()}, Path("flat.csv")
    )
    with ThreadPoolExecutor(1) as pool:
        done = diagnose(bench, [recording], [], pool)
    assert done.verdict == "bad_data" and word in done.reasons[0]


def test_linear_algebra_has_one_thread_while_fits_run_side_by_side(bench) -> None:
    from concurrent.futures import ThreadPoolExecutor

    from threadpoolctl import threadpool_info, threadpool_limits

    from hydrolek_drake.diagnosis.diagnosis import diagnose

    def threads(_: str = "") -> None:
        counts.append([pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"])

    counts: list[list[int]] = []
    flat = {"joint.command": np.full(TIME.size, 3.0), "joint.angle": _moving()}
    with threadpool_limits(limits=2, user_api="blas"), ThreadPoolExecutor(1) as pool:
        diagnose(bench, [Recording("flat", TIME, flat, Path("flat.csv"))], [], pool, threads)
        threads()
    during, after = counts[0], counts[-1]
    assert during and set(during) == {1}
    assert set(after) == {2}
