"""The functions for notebooks: what they take, what results can do, and that they are loaded only when asked for."""

import json
import subprocess
import sys

import numpy as np
import pytest

import hydrolek_drake
from hydrolek_drake.errors import InputError

pandas = pytest.importorskip("pandas")

BENCH = "tests/data/bench/practice_01/train.csv"


@pytest.fixture(scope="module")
def recording(request):
    return hydrolek_drake.read(request.config.rootpath / BENCH).between(0.0, 6.0)


def test_a_recording_goes_to_pandas_and_back(recording):
    frame = hydrolek_drake.to_pandas(recording)
    again = hydrolek_drake.read(frame)
    assert frame.columns[0] == "time_s" and again.signals.keys() == recording.signals.keys()
    for key, values in recording.signals.items():
        np.testing.assert_allclose(again.signals[key], values, rtol=1e-12)


def test_a_replay_is_a_result_with_summary_table_picture_and_html(recording):
    result = hydrolek_drake.replay("joint_bench", recording, progress=False)
    assert "joint.angle" in result.summary() and str(result) == result.summary()
    assert result.to_pandas().loc["joint.angle", "rms"] > 0.0
    assert len(result.plot().data) >= 3
    assert "<table" in result._repr_html_()


def test_a_fit_takes_frames_and_gives_a_rig(recording):
    frame = hydrolek_drake.to_pandas(recording)
    result = hydrolek_drake.fit(
        "joint_bench", frame, parameters=["command.delay"], method="de", budget=40, progress=False
    )
    table = result.to_pandas()
    path = "joints.joint.command.delay"
    assert table.loc[path, "low"] <= table.loc[path, "value"] == result.rig.value("command.delay")


def test_settings_and_loaded_rigs():
    rig = hydrolek_drake.load_rig("joint_bench", settings={"supply.pressure": "12 MPa"})
    assert rig.value("supply.pressure") == pytest.approx(12e6)
    assert hydrolek_drake.load_rig(rig) is rig
    with pytest.raises(InputError, match="with_values"):
        hydrolek_drake.load_rig(rig, settings={"supply.pressure": 1e7})


def test_nothing_is_loaded_before_it_is_asked_for():
    program = (
        "import json, sys, hydrolek_drake; dir(hydrolek_drake); "
        "print(json.dumps([name for name in "
        " ('numpy', 'numba', 'scipy', 'pandas', 'plotly', 'rich') if name in sys.modules]))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = done.stdout.strip()
    assert not {"numba", "scipy", "pandas", "plotly", "rich"} & set(json.loads(loaded))
    with pytest.raises(AttributeError, match="nonsense"):
        _ = hydrolek_drake.nonsense
