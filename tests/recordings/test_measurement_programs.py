"""Files and objects of other programs' measurements: MDF, MATLAB's tables and timetables, pandas."""

import importlib.util
import subprocess
import sys

import asammdf
import numpy as np
import pandas as pd
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording

matio = pytest.importorskip("matio", reason="mat-io needs Python 3.11")
TIME = 0.01 * np.arange(100)


def write_mdf(path, groups):
    """Groups of (name, values, time, unit), each group with its own clock."""
    with asammdf.MDF(version="3.30" if path.suffix == ".mdf" else "4.10") as file:
        for signals in groups:
            file.append(
                [asammdf.Signal(values, time, unit=unit, name=name) for name, values, time, unit in signals],
                common_timebase=True,
            )
        file.save(path)
    return path


@pytest.mark.parametrize("suffix", [".mf4", ".mdf"])
def test_mdf_with_groups_of_two_rates(tmp_path, suffix):
    slow = 0.04 * np.arange(25)
    path = write_mdf(
        tmp_path / f"run{suffix}",
        [
            [("ValveCmd", slow, slow, "V"), ("Counter", np.arange(25), slow, "")],
            [("boom.angle", 10 * TIME, TIME, "deg"), ("P_A", 200 * TIME, TIME, "bar")],
        ],
    )
    mapping = {"ValveCmd": "boom.command_V", "P_A": "boom.pressure_a_bar"}
    recording = read_recording(path, mapping)
    np.testing.assert_allclose(recording.time, TIME, atol=1e-12)
    np.testing.assert_allclose(recording.signal("boom.angle"), np.deg2rad(10 * TIME), rtol=1e-12)
    np.testing.assert_allclose(recording.signal("boom.pressure_a"), 2e7 * TIME, rtol=1e-12)
    np.testing.assert_allclose(recording.signal("boom.command"), 0.04 * (np.arange(100) // 4), atol=1e-12)
    assert any("Counter" in name for name in recording.ignored)


def test_mdf_channels_of_one_name_are_told_apart_by_their_group(tmp_path):
    path = write_mdf(
        tmp_path / "run.mf4",
        [[("x", TIME, TIME, "V")], [("x", 3 * TIME, TIME, "V")], [("y", TIME, TIME, "")]],
    )
    recording = read_recording(path, {"group1.x": "j.command_V", "y": "j.angle_deg"})
    np.testing.assert_allclose(recording.signal("j.command"), 3 * TIME)


@pytest.mark.parametrize("version", ["v7", "v7.3"])
@pytest.mark.filterwarnings("ignore")
def test_matlab_timetables(tmp_path, version):
    """Two timetables of their own rates, one of them in a struct, and a table with its own column of times."""
    slow = pd.to_timedelta(40 * np.arange(25), unit="ms")
    commands = pd.DataFrame({"u": np.arange(25.0)}, index=pd.Index(slow, name="Time"))
    fast = pd.Index(pd.to_timedelta(10 * np.arange(100), unit="ms"), name="Time")
    sensors = pd.DataFrame({"q": np.rad2deg(TIME), "p": 10 * TIME}, index=fast)
    matio.save_to_mat(tmp_path / "run.mat", {"commands": commands, "log": {"daq": sensors}}, version=version)
    mapping = {"commands.u": "j.command_V", "q": "j.angle_deg", "log.daq.p": "j.pressure_a_MPa"}
    recording = read_recording(tmp_path / "run.mat", mapping)
    np.testing.assert_allclose(recording.time, TIME, atol=1e-12)
    np.testing.assert_allclose(recording.signal("j.angle"), TIME, rtol=1e-12)
    np.testing.assert_allclose(recording.signal("j.pressure_a"), 1e7 * TIME, rtol=1e-12)
    np.testing.assert_allclose(recording.signal("j.command"), np.arange(100) // 4)
    table = pd.DataFrame({"t": 1e3 * TIME, "u": TIME, "q": 2 * TIME})
    matio.save_to_mat(tmp_path / "table.mat", {"run": table}, version=version)
    recording = read_recording(
        tmp_path / "table.mat", {"t": "time_ms", "u": "j.command_V", "q": "j.angle_rad"}
    )
    np.testing.assert_allclose(recording.time, TIME, rtol=1e-12)
    np.testing.assert_allclose(recording.signal("j.angle"), 2 * TIME)


@pytest.mark.filterwarnings("ignore")
def test_plain_arrays_are_read_where_the_objects_beside_them_cannot_be(tmp_path):
    path = tmp_path / "run.mat"
    frame = pd.DataFrame({"x": TIME}, index=pd.Index(pd.to_timedelta(TIME, unit="s"), name="Time"))
    matio.save_to_mat(path, {"log": frame, "t": TIME, "u": TIME, "q": 2 * TIME}, version="v7")
    data = bytearray(path.read_bytes())
    data[116:124] = (1).to_bytes(8, "little")  # where the objects are kept
    path.write_bytes(data)
    recording = read_recording(path, {"t": "time_s", "u": "j.command_V", "q": "j.angle_rad"})
    np.testing.assert_array_equal(recording.signal("j.angle"), 2 * TIME)
    with pytest.raises(InputError, match=r"no signal.*its tables and objects cannot be read"):
        read_recording(path, {"t": "time_s"})


def test_what_is_not_installed_is_told_with_how_to_install_it(tmp_path, monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name in ("asammdf", "matio") else found(name)
    )
    path = write_mdf(tmp_path / "run.mf4", [[("j.angle_deg", TIME, TIME, "")]])
    with pytest.raises(InputError, match=r"not installed: pip install 'hydrolek-drake\[formats\]'"):
        read_recording(path)
    frame = pd.DataFrame({"u": TIME}, index=pd.Index(pd.to_timedelta(TIME, unit="s"), name="Time"))
    matio.save_to_mat(tmp_path / "run.mat", {"log": frame}, version="v7.3")
    with pytest.raises(InputError, match=r"no time column.*pip install 'hydrolek-drake\[formats\]'"):
        read_recording(tmp_path / "run.mat")


FRAMES = {
    "durations": lambda data: data.set_index(pd.to_timedelta(TIME, unit="s")),
    "dates": lambda data: data.set_index(pd.Timestamp("2024-05-01") + pd.to_timedelta(TIME, unit="s")),
    "dates with a zone": lambda data: data.set_index(
        pd.Timestamp("2024-05-01", tz="Europe/Berlin") + pd.to_timedelta(TIME, unit="s")
    ),
    "floats": lambda data: data.set_index(TIME),
    "named milliseconds": lambda data: data.set_index(pd.Index(1e3 * TIME, name="time_ms")),
    "a column": lambda data: data.assign(time_s=TIME),
    "a column, rows left out": lambda data: pd.concat([data[:0], data.assign(time_s=TIME)]),
    "a column of dates": lambda data: data.assign(
        time=pd.Timestamp("2024-05-01") + pd.to_timedelta(TIME, unit="s")
    ),
}


@pytest.mark.parametrize("made", FRAMES.values(), ids=FRAMES.keys())
def test_data_frames(made):
    data = pd.DataFrame(
        {
            "j.angle_deg": np.rad2deg(TIME),
            "u": pd.array([None, *range(99)], dtype="Int64"),
            "note": ["a"] * 100,
        }
    )
    recording = read_recording(made(data), {"u": "j.command_V"})
    np.testing.assert_allclose(recording.time - recording.time[0], TIME, atol=1e-6)
    np.testing.assert_allclose(recording.signal("j.angle"), TIME, rtol=1e-14)
    np.testing.assert_array_equal(recording.signal("j.command"), [np.nan, *range(99)])
    assert recording.ignored == ("note",)


def test_data_frames_of_two_levels_and_bad_ones():
    levels = pd.DataFrame(
        {("j", "angle_deg"): TIME, ("j", "command_V"): TIME}, index=pd.Index(TIME, name="time_s")
    )
    assert set(read_recording(levels).signals) == {"j.angle", "j.command"}
    with pytest.raises(InputError, match="DataFrame has no time column"):
        read_recording(pd.DataFrame({"j.angle_deg": TIME}))
    with pytest.raises(InputError, match=r"DataFrame: column 'j.angle_deg' has 'x' in row 1"):
        read_recording(pd.DataFrame({"time_s": [0.0, 1.0], "j.angle_deg": ["x", "y"]}))


def test_reading_other_formats_loads_none_of_these_packages(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time_s,j.angle_deg\n0,1\n1,2\n")
    program = (
        "import sys; from hydrolek_drake.recordings import read_recording; loaded = 'pandas' in sys.modules;"
        "read_recording(sys.argv[1]);"  # pyarrow loads pandas by itself where it is installed
        "print(loaded, [name for name in ('asammdf', 'matio', 'rosbags', 'scipy') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program, path], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False []"
