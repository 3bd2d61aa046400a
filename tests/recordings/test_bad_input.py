"""Bad files are refused with one line that names the file and what is wrong; nothing else is ever raised."""

import os
import warnings

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nptdms import ChannelObject, TdmsWriter

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.recordings.apart import process


def refusal(path, columns=None):
    with pytest.raises(InputError) as refused:
        read_recording(path, columns)
    message = str(refused.value)
    assert "\n" not in message
    assert path.name in message
    return message


HEADER = "time_s,j.command_V,j.angle_deg\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is empty"),
        ("\n\n# only a comment\n", "is empty"),
        (HEADER, "no rows"),
        ("0,0,1\n0.1,0,2\n", "line 1 holds numbers; the first row must name the columns"),
        ("a,b\n0,1\n1,2\n", "no time column; it needs time_s"),
        ("time,j.angle_deg\n0,1\n1,2\n", "no time column; it needs time_s"),
        ("time_parsec,j.angle_deg\n0,1\n1,2\n", "it has 'time_parsec', 'j.angle_deg'"),
        ("time_s,a\n0,1\n1,2\n", "no signal: none of its columns is named <joint>.<quantity>_<unit>"),
        (HEADER + "0,0,1\n0.1,x,2\n", "column 'j.command_V' has 'x' in line 3"),
        (HEADER + "0,0,1\n\n# note\n0.1,0,1_0\n", "column 'j.angle_deg' has '1_0' in line 5"),
        (HEADER + "0,0,1\nlater,0,2\n", "column 'time_s' has 'later' in line 3"),
        (HEADER + "0,0,1\n0.2,0,1\n0.1,0,2\n", "runs backwards in line 4, from 0.2 s to 0.1 s"),
        (HEADER + "0,0,1\n,0,1\n0.1,0,2\n", "column 'time_s' is nan in line 3"),
        (HEADER + "0,0,1\ninf,0,1\n", "column 'time_s' is inf in line 3"),
        (HEADER + "0,,1\n1,,1\n", "column 'j.command_V' holds no number in any row"),
        (HEADER + "0,0,1\n", "at least two"),
        (HEADER + "0,0,1\n0,0,1\n", "at least two"),
        (HEADER + "0,0,1\n1,0\n", "line 3 has 2 cells; the header has 3"),
        (HEADER + "0,0,1\n1,0,1,5\n2,0,1\n", "line 3 has 4 cells; the header has 3"),
        ("time_s,j.angle_deg,j.angle_deg\n0,1,1\n1,2,2\n", "column 'j.angle_deg' is present twice"),
        (
            "time_s,j.angle_deg,j.angle_rad\n0,1,1\n1,2,2\n",
            "'j.angle_deg' and 'j.angle_rad' both hold j.angle",
        ),
        ("time_s,time_ms,j.angle_deg\n0,0,1\n1,1000,2\n", "'time_s' and 'time_ms' both hold time"),
        ("time_s,j.angle_furlong\n0,1\n1,2\n", "has the unit 'furlong', which does not measure angle"),
        ("time_s,j.angle\n0,1\n1,2\n", "column 'j.angle' has no unit"),
    ],
)
def test_csv(write_lines, text, says):
    assert says in refusal(write_lines(text))


def test_two_columns_mapped_to_one(write_lines):
    message = refusal(
        write_lines("t,a,b\n0,1,1\n1,2,2\n"), {"t": "time_s", "a": "j.angle_deg", "b": "j.angle_deg"}
    )
    assert "'a' and 'b' both hold j.angle" in message


def test_missing_file(tmp_path):
    assert "does not exist" in refusal(tmp_path / "nothing.csv")


def test_unknown_format_lists_the_known_ones(write_lines):
    assert ".csv, .tsv, .txt, .parquet, .tdms, .mat, .mf4, .mdf, .mcap, .db3, .bag" in refusal(
        write_lines("x", "run.xlsx")
    )


def test_parquet(tmp_path):
    path = tmp_path / "bad.parquet"
    good = {"time_s": [0.0, 0.1, 0.2], "j.angle_deg": [1.0, 2.0, 3.0]}

    def written(columns):
        pyarrow.parquet.write_table(pyarrow.table(columns), path)
        return path

    assert "no rows" in refusal(written({name: np.zeros(0) for name in good}))
    assert "column 'j.angle_deg' has 'x' in row 2" in refusal(
        written(good | {"j.angle_deg": ["1", "x", "2"]})
    )
    assert "runs backwards in row 3" in refusal(written(good | {"time_s": [0.0, 0.1, 0.05]}))
    assert "is nan in row 2" in refusal(written(good | {"time_s": pyarrow.array([0.0, None, 0.2])}))
    twice = pyarrow.Table.from_arrays(
        [pyarrow.array([0.0, 1.0])] * 3, names=["time_s", "j.angle_deg", "j.angle_deg"]
    )
    pyarrow.parquet.write_table(twice, path)
    assert "'j.angle_deg' is present twice" in refusal(path)


def test_mat(tmp_path):
    path = tmp_path / "bad.mat"
    scipy.io.savemat(path, {"t": np.arange(5.0), "q": np.arange(4.0)})
    assert "column 'q' has 4 rows; the time column 't' has 5" in refusal(
        path, {"t": "time_s", "q": "j.angle_deg"}
    )
    assert "no time column; it needs time_s" in refusal(path)
    scipy.io.savemat(path, {"t": np.arange(3.0), "q": np.array([1 + 2j, 0, 0])})
    assert "column 'q' has (1+2j) in row 1" in refusal(path, {"t": "time_s", "q": "j.angle_deg"})
    scipy.io.savemat(path, {"t": np.arange(3.0)}, format="4")
    assert "version 5 or later" in refusal(path)


def test_tdms(tmp_path):
    path = tmp_path / "bad.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("g", "j.angle_deg", np.arange(4.0))])
    assert "no time column" in refusal(path)
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("g", "j.angle_deg", np.arange(4.0), {"wf_increment": 0.0})])
    assert "wf_increment 0.0; it must be above zero" in refusal(path)


@pytest.fixture
def good_files(tmp_path, write_joint_states):
    """One good file of each binary format."""
    columns = {"time_s": 0.1 * np.arange(50), "j.angle_deg": np.arange(50.0)}
    pyarrow.parquet.write_table(pyarrow.table(columns), tmp_path / "good.parquet")
    with TdmsWriter(tmp_path / "good.tdms") as writer:
        writer.write_segment([ChannelObject("g", name, values) for name, values in columns.items()])
    struct = {"time_s": columns["time_s"], "j": {"angle_deg": columns["j.angle_deg"]}}
    scipy.io.savemat(tmp_path / "good.mat", {"log": struct}, do_compression=True)
    messages = [("/s", i * 10**8, i * 10**8, ["j"], [float(i)], [], []) for i in range(50)]
    write_joint_states(tmp_path / "good.mcap", messages)
    return tmp_path


@pytest.mark.parametrize("part", [0.01, 0.3, 0.97])
@pytest.mark.parametrize("extension", ["parquet", "mat", "mcap"])
def test_truncated_files_are_refused(good_files, extension, part):
    path = good_files / f"good.{extension}"
    read_recording(path)
    data = path.read_bytes()
    path.write_bytes(data[: int(part * len(data))])
    refusal(path)


def test_tdms_that_breaks_off_before_its_first_samples_is_refused(good_files):
    path = good_files / "good.tdms"
    data = path.read_bytes()
    for size in (4, 27, 28, 100):
        path.write_bytes(data[:size])
        refusal(path)


# A segment here is a lead-in and metadata of about 150 bytes, then 20 times, then 20 angles, 8 bytes each.
@pytest.mark.parametrize(("missing", "left"), [(0, 50), (5 * 8, 45), (5 * 8 + 3, 44), (330, 30), (400, 30)])
def test_tdms_that_breaks_off_is_read_to_its_end_and_reported(tmp_path, missing, left):
    path = tmp_path / "run.tdms"
    time = 0.1 * np.arange(50)
    with TdmsWriter(path) as writer:
        for rows in (slice(0, 30), slice(30, 50)):
            writer.write_segment(
                [
                    ChannelObject("g", "time_s", time[rows]),
                    ChannelObject("g", "j.angle_deg", np.cos(time[rows])),
                ]
            )
    data = path.read_bytes()
    path.write_bytes(data[: len(data) - missing])
    recording = read_recording(path)
    np.testing.assert_array_equal(recording.time, time[:left])
    np.testing.assert_array_equal(recording.signal("j.angle"), np.deg2rad(np.cos(time[:left])))
    if missing:
        (found,) = recording.findings
        assert found.kind == "gap"
        assert found.message.startswith(f"the file breaks off after {time[left - 1]:.9g} s")
    else:
        assert recording.findings == ()


@pytest.mark.parametrize(("byte", "value"), [(0x90, 5), (0xFC, 1), (0x101, 255)])
def test_mat_whose_stated_lengths_are_wrong_does_not_end_the_interpreter(tmp_path, byte, value):
    """Such a byte makes SciPy's parser read beyond its memory."""
    path = tmp_path / "bad.mat"
    log = {"time_s": 0.1 * np.arange(50), "j": {"angle_deg": np.arange(50.0)}}
    scipy.io.savemat(path, {"log": log})
    data = bytearray(path.read_bytes())
    data[byte] = value
    path.write_bytes(data)
    assert "cannot be read, it may be damaged" in refusal(path)


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    extension=st.sampled_from(["csv", "tsv", "txt", "parquet", "tdms"]),
    start=st.sampled_from(
        [
            b"",
            b"PAR1",
            b"TDSm",
            b"time_s,j.angle_deg\n",
            b"time_s;j.command_V\n0;1\n",
            b"\xff\xfe",
        ]
    ),
    data=st.binary(max_size=300) | st.text('0123456789.,;-e\n\t"naif#', max_size=80).map(str.encode),
)
def test_arbitrary_bytes_raise_only_input_error(tmp_path, extension, start, data):
    path = tmp_path / f"random.{extension}"
    path.write_bytes(start + data)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # parsers may remark on what they meet
        try:
            read_recording(path)
        except InputError as error:
            assert "\n" not in str(error)
            assert path.name in str(error)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    extension=st.sampled_from(["parquet", "tdms"]),
    place=st.floats(0, 1, exclude_max=True),
    value=st.integers(0, 255),
)
def test_one_damaged_byte_raises_only_input_error(good_files, extension, place, value):
    data = bytearray((good_files / f"good.{extension}").read_bytes())
    data[int(place * len(data))] = value
    path = good_files / f"damaged.{extension}"
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            read_recording(path)
        except InputError as error:
            assert "\n" not in str(error)
            assert path.name in str(error)


@pytest.mark.parametrize(
    ("program", "says"),
    [
        (  # the parser never ends
            "import itertools, scipy.io\n"
            "scipy.io.loadmat = lambda *_, **__: [None for _ in itertools.count() if False]\n"
            "from hydrolek_drake.recordings.apart.child import main; main()",
            "was not read within 1 s of processor time",
        ),
        ("import time; time.sleep(100)", "did not end within 5 s"),  # it does not even begin
    ],
)
@pytest.mark.thorough
def test_a_mat_file_that_is_read_for_ever_is_given_up(tmp_path, monkeypatch, program, says):
    """Reading is done in a process of its own, which is ended when its time is up."""
    path = tmp_path / "slow.mat"
    scipy.io.savemat(path, {"time_s": 0.1 * np.arange(50.0), "j": np.arange(50.0)})
    process_id = tmp_path / "id"
    noted = f"import os; open({str(process_id)!r}, 'w').write(str(os.getpid()))\n"
    monkeypatch.setattr(process, "_CHILD", ("-c", noted + program))
    monkeypatch.setattr(process, "LONGEST_S", 0.5)
    monkeypatch.setattr(process, "START_S", 1.0 if "scipy" not in program else 60.0)
    assert says in refusal(path)
    with pytest.raises(ProcessLookupError):
        os.kill(int(process_id.read_text()), 0)
