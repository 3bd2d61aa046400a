"""The same numbers come back from every format."""

import h5py
import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
import scipy.io
from nptdms import ChannelObject, TdmsWriter

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording, write_recording, write_signals


def table_text(columns, separator=",", comma=False):
    rows = [separator.join(columns)]
    for row in zip(*columns.values(), strict=True):
        line = separator.join(repr(float(value)) for value in row)
        rows.append(line.replace(".", ",") if comma else line)
    return "\n".join(rows) + "\n"


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_csv(columns, check_same, write_lines, separator):
    check_same(read_recording(write_lines(table_text(columns, separator))))


def test_csv_with_decimal_comma(columns, check_same, write_lines):
    check_same(read_recording(write_lines(table_text(columns, ";", comma=True))))


def test_decimal_comma_is_not_guessed_where_points_are_used(write_lines):
    path = write_lines("time_s;j.angle_deg\n0.0;1,234\n0.1;1,235\n")
    with pytest.raises(InputError, match=r"'1,234' in line 2"):
        read_recording(path)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_csv_encodings(columns, check_same, tmp_path, encoding):
    path = tmp_path / "run.CSV"
    path.write_bytes(("# Prüfstand\r\n\r\n" + table_text(columns).replace("\n", "\r\n")).encode(encoding))
    check_same(read_recording(path))


def test_csv_empty_cells_are_nan_and_unknown_columns_listed(write_lines):
    path = write_lines('time_s,j.angle_rad,note,"date, time",\n0,1,start,x,\n1,,,y,\n2,3,,z,\n')
    recording = read_recording(path)
    np.testing.assert_array_equal(recording.signal("j.angle"), [1, np.nan, 3])
    assert recording.ignored == ("note", "date, time")


def test_parquet(columns, check_same, tmp_path):
    path = tmp_path / "run.parquet"
    pyarrow.parquet.write_table(pyarrow.table(columns), path)
    check_same(read_recording(path))


def test_content_decides_where_the_extension_is_unknown(columns, check_same, tmp_path):
    path = tmp_path / "run.log"
    pyarrow.parquet.write_table(pyarrow.table(columns), path)
    check_same(read_recording(path))


def test_parquet_types(tmp_path):
    path = tmp_path / "run.parquet"
    stamps = np.array(
        ["2024-05-01T12:00:00.000", "2024-05-01T12:00:00.250", "2024-05-01T12:00:00.500"], "M8[ms]"
    )
    table = pyarrow.table(
        {
            "time": stamps,
            "j.command_V": pyarrow.array([1, None, 3], pyarrow.int16()),
            "j.angle_rad": pyarrow.array(["0.5", "1.5", None]),
            "note": ["a", "b", "c"],
        }
    )
    pyarrow.parquet.write_table(table, path)
    recording = read_recording(path)
    np.testing.assert_array_equal(recording.time - recording.time[0], [0, 0.25, 0.5])
    np.testing.assert_array_equal(recording.signal("j.command"), [1, np.nan, 3])
    np.testing.assert_array_equal(recording.signal("j.angle"), [0.5, 1.5, np.nan])
    assert recording.ignored == ("note",)


def write_tdms(path, channels):
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject(*channel) for channel in channels])
    return path


def test_tdms_with_full_channel_names(columns, check_same, tmp_path):
    path = write_tdms(tmp_path / "run.tdms", [("Measured", name, values) for name, values in columns.items()])
    check_same(read_recording(path))


def test_tdms_with_the_joint_as_group(columns, check_same, tmp_path):
    groups = [("clock" if "." not in name else name.split(".")[0], name.split(".")[-1]) for name in columns]
    path = write_tdms(
        tmp_path / "run.tdms",
        [(*names, values) for names, values in zip(groups, columns.values(), strict=True)],
    )
    check_same(read_recording(path))


def test_tdms_waveform_time(tmp_path):
    waveform = {"wf_increment": 0.005, "wf_start_offset": 0.25}
    values = np.sin(np.arange(50.0))
    path = write_tdms(
        tmp_path / "run.tdms",
        [("g", "j.command_V", values, waveform), ("g", "j.angle_deg", values, waveform)],
    )
    recording = read_recording(path)
    np.testing.assert_allclose(recording.time, 0.25 + 0.005 * np.arange(50), rtol=1e-15)
    np.testing.assert_allclose(recording.signal("j.angle"), np.deg2rad(values), rtol=1e-14)


def test_tdms_time_stamps(tmp_path):
    stamps = np.datetime64("2024-05-01T12:00:00", "us") + np.arange(20) * np.timedelta64(10_000, "us")
    path = write_tdms(tmp_path / "run.tdms", [("g", "time", stamps), ("g", "j.angle_rad", np.arange(20.0))])
    time = read_recording(path).time
    np.testing.assert_allclose(
        time - time[0], 0.01 * np.arange(20), atol=1e-6
    )  # seconds since 1970 in double


def test_tdms_waveforms_of_their_own_rates_and_beginnings(tmp_path):
    """The command is set at 10 Hz, half a second before the angle's first sample at 50 Hz."""
    begun = np.datetime64("2024-05-01T12:00:00", "us")
    path = write_tdms(
        tmp_path / "run.tdms",
        [
            ("g", "j.command_V", np.arange(20.0), {"wf_increment": 0.1, "wf_start_time": begun}),
            (
                "h",
                "j.angle_rad",
                np.arange(50.0),
                {"wf_increment": 0.02, "wf_start_time": begun + np.timedelta64(500, "ms")},
            ),
        ],
    )
    recording = read_recording(path)
    np.testing.assert_allclose(recording.time, 0.5 + 0.02 * np.arange(50), atol=1e-12)
    np.testing.assert_array_equal(recording.signal("j.angle"), np.arange(50.0))
    np.testing.assert_array_equal(recording.signal("j.command")[1:6], [5, 5, 5, 5, 6])


def test_tdms_groups_with_times_of_their_own(tmp_path):
    fast, slow = 0.01 * np.arange(100), 0.04 * np.arange(25)
    path = write_tdms(
        tmp_path / "run.tdms",
        [
            ("drive", "time_s", slow),
            ("drive", "j.command_V", np.arange(25.0)),
            ("daq", "time_s", fast),
            ("daq", "j.angle_rad", fast),
        ],
    )
    recording = read_recording(path)
    np.testing.assert_array_equal(recording.time, fast)
    np.testing.assert_array_equal(recording.signal("j.command")[5::4], np.arange(1.0, 25.0))


MAT_NAMES = {
    "t": "time_s",
    "u": "right_j2.command_V",
    "q": "right_j2.angle_deg",
    "p": "right_j2.pressure_a_MPa",
}


def mat_variables(columns, shape):
    return {short: columns[name].reshape(shape) for short, name in MAT_NAMES.items()} | {
        "gain": 3.0,
        "note": "text",
    }


@pytest.mark.parametrize("shape", [(-1, 1), (1, -1)])
def test_mat_5(columns, check_same, tmp_path, shape):
    scipy.io.savemat(tmp_path / "run.mat", mat_variables(columns, shape), do_compression=True)
    check_same(read_recording(tmp_path / "run.mat", MAT_NAMES))


def test_mat_struct_is_mapped_by_full_or_short_name(columns, check_same, tmp_path):
    scipy.io.savemat(tmp_path / "run.mat", {"log": mat_variables(columns, (-1, 1))})
    check_same(read_recording(tmp_path / "run.mat", MAT_NAMES))
    check_same(
        read_recording(tmp_path / "run.mat", {f"log.{short}": name for short, name in MAT_NAMES.items()})
    )


def test_mat_struct_of_joints_needs_no_mapping(columns, check_same, tmp_path):
    joint = {name.split(".")[1]: values for name, values in columns.items() if "." in name}
    scipy.io.savemat(tmp_path / "run.mat", {"log": {"time_s": columns["time_s"], "right_j2": joint}})
    check_same(read_recording(tmp_path / "run.mat"))


def write_mat_73(path, variables, group=""):
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in variables.items():
            if name == "note":
                item = file.create_dataset(f"{group}{name}", data=np.array([[116, 101]], dtype=np.uint16).T)
                item.attrs["MATLAB_class"] = np.bytes_("char")
            else:
                file.create_dataset(f"{group}{name}", data=np.atleast_2d(values))
    header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + (0x0200).to_bytes(2, "little") + b"IM"
    with path.open("r+b") as stream:
        stream.write(header)


@pytest.mark.parametrize("group", ["", "log/"])
def test_mat_73(columns, check_same, tmp_path, group):
    write_mat_73(tmp_path / "run.mat", mat_variables(columns, (1, -1)), group)
    check_same(read_recording(tmp_path / "run.mat", MAT_NAMES))


def test_mapping_comes_first_and_absent_names_do_not_matter(columns, write_lines):
    path = write_lines(table_text(columns))
    recording = read_recording(
        path,
        {
            "right_j2.angle_deg": "left_j1.angle_deg",
            "right_j2.command_V": "ignore",
            "position": "axis.position_mm",
        },
    )
    assert set(recording.signals) == {"left_j1.angle", "right_j2.pressure_a"}
    assert recording.ignored == ("right_j2.command_V",)


@pytest.mark.parametrize("extension", ["csv", "parquet"])
def test_written_recording_reads_back_to_the_bit(columns, write_lines, tmp_path, extension):
    columns["right_j2.angle_deg"][5:8] = np.nan
    first = read_recording(write_lines(table_text(columns).replace("nan", "")))
    second = read_recording(write_recording(first, tmp_path / f"copy.{extension}"))
    np.testing.assert_array_equal(second.time, first.time)
    assert second.units == first.units
    for key, values in first.signals.items():
        np.testing.assert_array_equal(second.signal(key), values)


def test_writing_names_units_and_leaves_no_partial_file(tmp_path):
    path = write_signals(
        tmp_path / "out.csv",
        np.arange(2.0),
        {"j.rate": [1, np.nan], "j.dead_band": [0, 1]},
        {"j.dead_band": "m"},
    )
    assert path.read_text() == "time_s,j.rate_rad_per_s,j.dead_band_m\n0,1,0\n1,,1\n"
    with pytest.raises(InputError, match=r"use the extension .csv or .parquet"):
        write_signals(tmp_path / "out.xlsx", np.arange(2.0), {})
    with pytest.raises(InputError, match=r"signal j.other has no unit"):
        write_signals(path, np.arange(2.0), {"j.other": np.zeros(2)})
    with pytest.raises(InputError, match=r"j.angle has shape \(3,\)"):
        write_signals(path, np.arange(2.0), {"j.angle": np.zeros(3)})
    with pytest.raises(InputError, match=r"cannot write"):
        write_signals(tmp_path / "nowhere" / "out.csv", np.arange(2.0), {})
    assert [file.name for file in tmp_path.iterdir()] == ["out.csv"]
    assert path.read_text().startswith("time_s,j.rate_rad_per_s")
