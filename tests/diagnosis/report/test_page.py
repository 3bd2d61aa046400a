"""The page holds what was found, draws it honestly, and fits a phone."""

import base64
import json
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from hydrolek_drake.diagnosis.report.fading import SHARES, fadings
from hydrolek_drake.diagnosis.report.page import page
from hydrolek_drake.diagnosis.report.panels import after
from hydrolek_drake.diagnosis.report.plot_data import plot_data, samples_kept
from hydrolek_drake.diagnosis.report.words import effect_sentence, headline
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.visualization.urdf_tree import arms_tree

LEAK, FRICTION = "cylinder.cross_port_leakage", "cylinder.coulomb_friction"
PLANTED = {LEAK: {"conductance_m3_per_s_Pa": 1.5e-12}, FRICTION: {"coulomb_N": 1200.0}}
MOST_BYTES = 3_000_000
EXTERNAL = re.compile(r"(?:src|href)\s*=|url\(|@import|fetch\(|XMLHttpRequest|WebSocket")


@pytest.fixture(scope="module")
def both(named):
    return named("joint_bench", PLANTED)


@pytest.fixture(scope="module")
def written(both):
    return page(both)


def _numbers(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), "<f4")


def test_the_page_keeps_its_exact_sentences_and_adds_equation_units_and_where_to_look(both, written) -> None:
    for candidate in both.best.hypothesis.listed:
        assert effect_sentence(candidate, both) in written
        assert EFFECTS[candidate.id].inspect in written.replace("&#x27;", "'")
    assert headline(both) in written
    assert written.count("<math") >= 2 and "l/min" in written and "at a pressure drop of 160 bar" in written
    look = re.search(r"<b>What to look at:</b> (.*?)</p>", written)
    assert look and look.group(1).startswith("joint, ")
    assert written.count("Probability:") == 1 and "posterior</th>" not in written


def test_the_page_needs_no_network_and_is_small(written) -> None:
    assert not EXTERNAL.search(re.sub(r"<script>/\*.*?</script>", "", written, flags=re.S))
    assert len(written.encode()) < MOST_BYTES


def test_an_effect_faded_in_fully_is_the_fitted_machine_and_without_it_the_machine_has_none(both) -> None:
    experiment = both.held_out[0]
    every, leak, friction = fadings(both)
    assert [leak.name, friction.name] == [LEAK, FRICTION]
    whole = after(both, experiment).reading
    for each in (every, leak, friction):
        np.testing.assert_allclose(each.signals(experiment)[-1].reading, whole, atol=1e-9)
    bare = both.rig.with_values(
        {k: v for k, v in both.best.hypothesis.values.items() if ".effects." not in k}
    )
    alone = experiment.simulate(bare.records(), both.step).signals.reading
    np.testing.assert_allclose(every.signals(experiment)[0].reading, alone, atol=1e-9)
    apart = [float(np.abs(s.reading - whole).max()) for s in leak.signals(experiment)]
    assert all(a >= b for a, b in pairwise(apart)) and apart[0] > 0.0


def test_the_data_of_the_plots_are_those_of_the_recordings(both) -> None:
    data = plot_data(both)
    assert data["shares"] == SHARES.tolist() and data["arm"] is None
    for recording, experiment in zip(
        data["recordings"], (both.bench.training[0], both.held_out[0]), strict=True
    ):
        chart = recording["charts"][0]
        np.testing.assert_allclose(_numbers(chart["x"]), experiment.time, rtol=1e-6)
        np.testing.assert_allclose(
            np.radians(_numbers(chart["measured"])), experiment.channels[0].measured, rtol=1e-5
        )
        assert len(chart["faded"]) == 3 and all(len(course) == len(SHARES) for course in chart["faded"])
    assert data["recordings"][0]["grown"] and not data["recordings"][1]["grown"]


def test_of_a_long_signal_the_peaks_of_every_group_are_kept() -> None:
    random = np.random.default_rng(5)
    signals = [random.standard_normal(40_000), random.standard_normal(40_000)]
    signals[0][[12_345, 20_000]] = 50.0, np.nan
    signals[1][30_001] = -50.0
    kept = samples_kept(signals, 2000)
    assert kept.size <= 2010 and np.all(np.diff(kept) > 0)
    assert {0, 12_345, 30_001, 39_999} <= set(kept.tolist())
    assert samples_kept(signals, 40_000).size == 40_000


def test_where_nothing_is_missing_nothing_can_be_faded(named) -> None:
    text = page(named("joint_bench", {}))
    assert "id='share'" not in text and "What to look at" not in text and "Nothing is missing" in text


def test_the_arm_of_a_rig_that_has_one_stands_as_it_was_measured(named) -> None:
    done = named("hydrolek_right_j2", {"cylinder.coulomb_friction": {"coulomb_N": 500.0}}, seconds=3.0)
    arm = plot_data(done)["arm"]
    assert arm["joint"] == "right_j2"
    experiment = done.bench.training[0]
    measured = _numbers(arm["recordings"][0]["right_j2"]["y"])
    np.testing.assert_allclose(measured, experiment.channels[0].measured, rtol=1e-6)
    angles = {**arm["posture"], "right_j2": float(measured[100])}
    poses: list[np.ndarray] = []
    for link in arm["links"]:
        pose = np.eye(4) if link["parent"] < 0 else poses[link["parent"]] @ _whole(link["origin"])
        if link.get("axis"):
            turned = np.eye(4)
            turned[:3, :3] = Rotation.from_rotvec(
                np.array(link["axis"]) * angles.get(link["joint"], 0.0)
            ).as_matrix()
            pose = pose @ turned
        poses.append(pose)
    right = arms_tree().link_poses(angles)["right_tool"]
    assert any(np.allclose(pose, right, atol=1e-3) for pose in poses)


def test_of_several_joints_only_what_acts_at_the_shown_one_fades(both) -> None:
    assert [each.name for each in fadings(both)] == ["all", LEAK, FRICTION]
    first, second = both.best.hypothesis.listed
    elsewhere = replace(both.best.hypothesis, effects=(first, replace(second, joint="another")))
    best = replace(both.best, hypothesis=elsewhere)
    other = replace(both, conclusion=replace(both.conclusion, best=best))
    assert [each.name for each in fadings(other)] == [first.id]


def _whole(pose: list[float]) -> np.ndarray:
    return np.vstack([np.reshape(pose, (3, 4)), [0.0, 0.0, 0.0, 1.0]])


def test_on_a_phone_nothing_scrolls_sideways_and_the_slider_moves_the_model(
    written, chromium_page, tmp_path
) -> None:
    (tmp_path / "report.html").write_text(written, encoding="utf-8")
    errors: list[str] = []
    chromium_page.on("pageerror", lambda error: errors.append(str(error)))
    chromium_page.goto((tmp_path / "report.html").as_uri())
    chromium_page.wait_for_selector(".uplot canvas")
    assert chromium_page.evaluate("document.documentElement.scrollWidth") <= 390
    boxes = chromium_page.evaluate(
        "[...document.querySelectorAll('.chart')].map(c => c.getBoundingClientRect()).map(b => [b.top, b.bottom])"
    )
    assert len(boxes) == 6 and all(a[1] <= b[0] for a, b in pairwise(boxes))
    column = "state.groups[0].plots[0].data[3]"
    full = chromium_page.evaluate(column)
    chromium_page.evaluate("const s = document.getElementById('share'); s.value = 0; s.oninput()")
    assert chromium_page.evaluate(column) != full
    chromium_page.evaluate("state.groups[0].plots[0].setCursor({left: 100, top: 20}, true, true)")
    legends = chromium_page.locator(".u-legend").all_inner_texts()
    assert re.search(r"measured\D*-?[\d.]+ deg", legends[0])  # the cursor tells it, in the other plots too
    assert re.search(r"left by the nominal model\D*-?[\d.e-]+ deg", legends[1]) and re.search(
        r"-?[\d.]+ V", legends[2]
    )
    chromium_page.evaluate("state.time[0] = 3; zoomed(state.groups[0], .5)")
    chromium_page.wait_for_function("state.groups[0].plots.every(u => u.scales.x.max - u.scales.x.min < 4)")
    chromium_page.set_viewport_size({"width": 844, "height": 390})
    chromium_page.wait_for_function("state.groups[0].plots.every(u => u.scales.x.max - u.scales.x.min < 4)")
    shown = json.loads(chromium_page.evaluate("JSON.stringify(state.groups[1].plots[0].scales.x)"))
    assert shown["max"] - shown["min"] > 5.0  # the other recording has its own time
    chromium_page.evaluate(
        "const over = state.groups[0].plots[0].over, box = over.getBoundingClientRect();"
        "const finger = new Touch({identifier: 1, target: over, clientX: box.left + 60, clientY: box.top + 9});"
        "over.dispatchEvent(new TouchEvent('touchmove', {touches: [finger]}))"
    )
    assert all(
        abs(left - 60) < 1 for left in chromium_page.evaluate("state.groups[0].plots.map(u => u.cursor.left)")
    )
    paper = "colour('paper')"
    for media, scheme, wanted in (
        ("screen", "dark", "#14181d"),
        ("print", "dark", "#ffffff"),
        ("screen", "light", "#ffffff"),
    ):
        chromium_page.emulate_media(media=media, color_scheme=scheme)
        assert chromium_page.evaluate(paper) == wanted
    assert not errors
