"""What a program leaves behind is whole: files, checkpoints, tables for a spreadsheet."""

import csv
import io
import json
import os
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import being_written, disarmed, read_kept, write_out, write_results, write_whole
from hydrolek_drake.identification.search.journal import Journal
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.teleop.trial import COLUMNS, SCALES, TrialLog


def test_a_write_that_fails_leaves_the_older_file_and_nothing_else(tmp_path):
    path = write_whole(tmp_path / "a.txt", "older")
    with pytest.raises(OSError, match="full"), being_written(path) as part:
        part.write_text("half")
        assert part.parent == path.parent and path.read_text() == "older"
        raise OSError("the disk is full")
    assert path.read_text() == "older"
    assert list(tmp_path.iterdir()) == [path]


def test_content_is_on_disk_before_it_takes_the_name(tmp_path, monkeypatch):
    done = []
    real_sync, real_replace = os.fsync, Path.replace

    def sync(handle):
        done.append(("fsync", os.path.basename(os.readlink(f"/proc/self/fd/{handle}"))))
        real_sync(handle)

    def replace(self, target):
        done.append(("replace", self.name))
        return real_replace(self, target)

    monkeypatch.setattr(os, "fsync", sync)
    monkeypatch.setattr(Path, "replace", replace)
    write_whole(tmp_path / "a.txt", "new")
    (synced, part), (replaced, same), (folder_synced, folder) = done
    assert (synced, replaced, folder_synced) == ("fsync", "replace", "fsync")
    assert part == same and folder == tmp_path.name


def test_a_name_that_fills_a_folder_s_limit_is_written(tmp_path):
    name = "x" * 251 + ".txt"
    assert write_whole(tmp_path / name, "a").read_text() == "a"


def test_results_that_cannot_be_written_are_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "file" / "a", Path("/proc/none/a")):
        with pytest.raises(InputError, match="cannot write there"):
            write_results(place, {"a.json": "{}"})
        with pytest.raises(InputError, match="cannot write there"):
            write_out(place / "a.json", "{}")


def test_no_module_writes_under_a_temporary_name_of_its_own():
    import hydrolek_drake

    package = Path(hydrolek_drake.__file__).parent
    found = [
        str(path.relative_to(package))
        for path in package.rglob("*.py")
        if '.part"' in path.read_text(encoding="utf-8") or "os.replace(" in path.read_text(encoding="utf-8")
    ]
    assert found == ["files.py"]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (bytes(4096), "is empty"),
        (b'{"verdict": "hea', "is cut off or damaged, line 1"),
        (b"\xff\xfe", "is cut off or damaged"),
        (b"[" * 100_000, "is cut off or damaged"),
        (b"[]", "lacks verdict"),
        (b"{}", "lacks verdict"),
    ],
)
def test_what_an_earlier_run_left_is_whole_or_refused(tmp_path, content, says):
    path = tmp_path / "report.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"report\.json: the report.*remove it to begin afresh") as caught:
        read_kept(path, "the report", ("verdict",))
    assert says in str(caught.value)


BELONGS = {"method": "de", "seed": 3}


def _journal(path, **changes):
    return Journal(path, BELONGS | changes, 2, 1)


def _filled(path):
    journal = _journal(path)
    units = np.arange(8.0).reshape(4, 2)
    journal.append(units[:3], [np.array([1.0])] * 3)
    journal.append(units[3:], [np.array([2.0])])
    journal.close()
    return path.read_bytes(), units


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (bytes(4096), "is empty"),
        (b'{"dimension": 2, "for', "is cut off within its first line"),
        (b"PK\x03\x04 something else\n", "is damaged, or no checkpoint at all"),
        (b"[1, 2]\n", "is damaged, or no checkpoint at all"),
        (b'{"dimension": 2, "method": "de", "seed": 3, "size": 1}\n', "written by another version"),
    ],
)
def test_a_checkpoint_says_what_is_wrong_with_it(tmp_path, content, says):
    path = tmp_path / "checkpoint"
    path.write_bytes(content)
    with pytest.raises(InputError, match="remove it to start afresh") as caught:
        _journal(path)
    assert says in str(caught.value)
    assert path.read_bytes() == content


def test_a_checkpoint_of_another_search_says_in_what_it_is_another(tmp_path):
    _filled(tmp_path / "checkpoint")
    with pytest.raises(InputError, match=r"belongs to another search \(other seed\)"):
        _journal(tmp_path / "checkpoint", seed=4)


def test_a_checkpoint_is_there_whole_or_not_at_all(tmp_path, monkeypatch):
    def full(handle):
        raise OSError("the disk is full")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="full"):
        _journal(tmp_path / "checkpoint")
    assert list(tmp_path.iterdir()) == []


def test_evaluations_are_on_disk_when_they_are_said_to_be(tmp_path, monkeypatch):
    journal = _journal(tmp_path / "checkpoint")
    synced = []
    monkeypatch.setattr(os, "fsync", lambda handle: synced.append(os.fstat(handle).st_size))
    journal.append(np.zeros((1, 2)), [np.array([1.0])])
    assert synced == [(tmp_path / "checkpoint").stat().st_size]
    journal.close()


@pytest.mark.parametrize("damage", ["cut", "zeros", "byte"])
def test_what_a_loss_of_power_has_torn_is_evaluated_again(tmp_path, damage):
    path = tmp_path / "checkpoint"
    whole, units = _filled(path)
    row = 8 * 4
    torn = {
        "cut": whole[:-5],
        "zeros": whole[:-row] + bytes(row),
        "byte": whole[: -row + 3] + b"\x7f" + whole[-row + 4 :],
    }[damage]
    path.write_bytes(torn)
    journal = _journal(path)
    assert len(journal.replayed(units)) == 3
    journal.append(units[3:], [np.array([2.0])])
    journal.close()
    assert path.read_bytes() == whole


FORMULAS = ["=1+1", "+1+1", "-1+1", "@SUM(A1)", "=cmd|' /C calc'!A0", "\uff1d1+1", '=HYPERLINK("http://x")']


@pytest.mark.parametrize("text", FORMULAS)
def test_a_trial_s_texts_are_no_formulas(tmp_path, text):
    log = TrialLog(tmp_path)
    log.timer("start")
    log.timer("stop")
    ratings = dict.fromkeys(SCALES, 5.0)
    log.save({"operator": text, "control": "assisted", "note": f"\t{text}\r", **ratings})
    (head, row) = csv.reader(io.StringIO((tmp_path / "trials.csv").read_text(encoding="utf-8")))
    assert tuple(head) == COLUMNS
    for name in ("operator", "note"):
        assert row[head.index(name)] == f"'{text}"
    assert not any(cell.startswith(("=", "+", "-", "@", "\t", "\r")) for cell in row)


@pytest.mark.parametrize("cell", ["-5", "+5.0", "-1e-3", "a=1", "5", "", "mail@example"])
def test_numbers_and_plain_text_stay_as_they_are(cell):
    assert disarmed(cell) == cell


def test_signals_have_names_that_are_no_formulas_and_keep_their_columns(tmp_path):
    time = np.arange(3.0)
    for name in (*FORMULAS[:4], "a\nb", "a\x00b"):
        with pytest.raises(InputError, match="spreadsheet"):
            write_signals(tmp_path / "a.csv", time, {f"{name}.angle": time})
    path = write_signals(tmp_path / "a.csv", time, {'a,"b".angle': time})
    with path.open(newline="", encoding="utf-8") as stream:
        assert next(csv.reader(stream)) == ["time_s", 'a,"b".angle_rad']


@pytest.mark.parametrize("content", ["", '{"verdict": "heal', json.dumps([])])
def test_a_challenge_does_not_go_on_from_a_report_that_is_torn(tmp_path, content):
    from hydrolek_drake.challenge.cases import CASE_KEYS

    (tmp_path / "case_001.json").write_text(content)
    with pytest.raises(InputError, match=r"case_001\.json.*remove it to begin afresh"):
        read_kept(tmp_path / "case_001.json", "the machine drawn before", CASE_KEYS)
