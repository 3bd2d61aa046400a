"""What a replay writes."""

import json

import cv2
import numpy as np
import pytest
from pyarrow import parquet

from hydrolek_drake.errors import InputError
from hydrolek_drake.replay import compare, replay
from hydrolek_drake.replay.report import write_report
from hydrolek_drake.rigs import load_rig


@pytest.fixture(scope="module")
def written(tmp_path_factory, bench_recording):
    folder = tmp_path_factory.mktemp("replay") / "new" / "folder"
    replayed = replay(load_rig("joint_bench"), bench_recording("practice_03"))
    comparisons = compare(replayed)
    write_report(replayed, comparisons, folder)
    return folder, replayed, comparisons


def test_all_files_and_nothing_else_are_there(written):
    folder, _, _ = written
    names = sorted(path.name for path in folder.iterdir())
    assert names == ["replay.html", "replay.json", "replay.png", "signals.parquet"]


def test_page_begins_with_the_sentence_and_needs_no_network(written):
    folder, _, (angle, *_) = written
    page = (folder / "replay.html").read_text(encoding="utf-8")
    body = page.index("<body>")
    assert body < page.index(angle.sentence()) < page.index("<table>") < page.index("plotly")
    assert "<script src=" not in page and "<link" not in page[: page.index("plotly")]
    assert page.count("id='plotly-packed'") == 1 and len(page) < 3e6


def test_picture_shows_both_curves_and_shaded_spans(written):
    folder, _, _ = written
    picture = cv2.imread(str(folder / "replay.png"))
    assert picture.shape[1] >= 1000
    blue_green_red = picture.reshape(-1, 3).astype(int)
    for colour in ((0x02, 0x5F, 0xD9), (0x22, 0x22, 0x22)):  # model, measured
        assert (np.abs(blue_green_red - colour).max(axis=1) < 12).sum() > 500
    shade = (np.abs(blue_green_red - (0xC1, 0xE9, 0xFA)).max(axis=1) < 12).sum()
    assert shade > 0.01 * len(blue_green_red)


def test_numbers_are_those_of_the_comparison(written):
    folder, _, comparisons = written
    numbers = json.loads((folder / "replay.json").read_text())
    assert numbers["schema"] == 1
    assert [signal["signal"] for signal in numbers["signals"]] == [c.key for c in comparisons]
    for signal, c in zip(numbers["signals"], comparisons, strict=True):
        assert signal["rms"] == c.rms and signal["noise"] == c.noise
        assert len(signal["worst_spans"]) == len(c.spans)


def test_residual_is_measured_minus_model(written):
    folder, replayed, _ = written
    table = parquet.read_table(folder / "signals.parquet")
    measured, model, residual = (
        table[f"joint.angle_{name}_rad"].to_numpy() for name in ("measured", "model", "residual")
    )
    np.testing.assert_array_equal(residual, measured - model)
    np.testing.assert_array_equal(table["time_s"].to_numpy(), replayed.recording.time)
    np.testing.assert_array_equal(measured, replayed.recording.signal("joint.angle"))


def test_folder_that_cannot_be_made_is_one_clear_line(written, tmp_path):
    _, replayed, comparisons = written
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"--out .*file.*cannot write"):
        write_report(replayed, comparisons, tmp_path / "file" / "out")
