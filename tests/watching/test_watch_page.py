"""The page of a watch in a real browser: on a phone, light and dark, and the recording behind a point."""

import numpy as np
import pytest

from hydrolek_drake.api.watch_result import WatchResult
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.alarms import AlarmRule, alarm_of, healthy_by, judged
from hydrolek_drake.watching.asking import Answer, EffectTold
from hydrolek_drake.watching.excitation import ReferenceTold
from hydrolek_drake.watching.limits import Limit
from hydrolek_drake.watching.page import page
from hydrolek_drake.watching.stamps import Stamp
from hydrolek_drake.watching.store import Seen
from hydrolek_drake.watching.watch import Watched

LEAKAGE, DROOP = "cylinder.cross_port_leakage", "supply.pressure_droop"
DAY_S, BEGIN_S = 86400.0, 1772668800.0
DEVIATION = 2e-14
OWN = "joints.joint.cylinder.viscous_friction"


def _answer(size):
    rises = tuple(
        ((s - size) / DEVIATION) ** 2 - (size / DEVIATION) ** 2 for s in (0.0, size, 2.0 * size + DEVIATION)
    )
    leakage = EffectTold(
        LEAKAGE, "joint", size, size - 2 * DEVIATION, size + 2 * DEVIATION, "m^3/(s Pa)", -min(rises), 1, 1.0, {},
        strengths=(0.0, size, 2.0 * size + DEVIATION), rises=rises,
    )  # fmt: skip
    droop = EffectTold(DROOP, "joint", 1e8, 0.0, 1e9, "Pa s/m^3", 0.5, 1, 1.0, {})
    curves = {name: [0.0, 1.0, 0.5] for name in ("time", "command", "measured", "nominal", "best")}
    told = {OWN: 0.02}
    return Answer((leakage, droop), {}, 1.0, 4000, 0.0, curves, "joint.angle [deg]", told, 40.0)


@pytest.fixture(scope="module")
def watched():
    """A machine that leaks more each day, with a reference that is too short."""
    rng = np.random.default_rng(2)
    sizes = [*(DEVIATION * abs(rng.standard_normal()) for _ in range(4)), *(1e-13 * n for n in range(1, 9))]
    stamps = [Stamp(BEGIN_S + DAY_S * n, "name") for n in range(len(sizes))]
    seen = tuple(
        Seen(f"/runs/a_folder_with_a_long_name/run_{n}.csv", f"{n:064d}", stamp, _answer(size))
        for n, (size, stamp) in enumerate(zip(sizes, stamps, strict=True))
    )
    answers = [each.answer for each in seen]
    reference = (
        Seen("reference.csv", "r", Stamp(BEGIN_S - DAY_S, "name"), _answer(DEVIATION), reference=True),
    )
    rule, healthy = AlarmRule(), healthy_by([reference[0].answer])
    judgements = tuple(judged(answer, n, rule, healthy) for n, answer in enumerate(answers, start=1))
    alarm = alarm_of(answers, judgements, rule)
    told = ReferenceTold({OWN: 0.1}, {OWN: 0.02}, 4.0)
    return Watched(
        load_rig("joint_bench"), reference, seen, rule, told, healthy, judgements, alarm, len(seen)
    )


@pytest.fixture(scope="module")
def address(watched, tmp_path_factory):
    """Of its page."""
    path = tmp_path_factory.mktemp("page") / "watch.html"
    text = page(watched, [Limit(LEAKAGE, 1.5e-12)])
    assert len(text) < 3e6  # it can be sent by mail
    path.write_text(text, encoding="utf-8")
    return path.as_uri()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_fits_a_phone_and_keeps_to_its_scheme(chromium_page, address, scheme):
    errors = []
    chromium_page.on("pageerror", lambda error: errors.append(str(error)))
    chromium_page.emulate_media(color_scheme=scheme)
    chromium_page.goto(address)
    chromium_page.wait_for_selector(".scatterlayer")
    chromium_page.locator("a[data-id]").last.click()
    chromium_page.wait_for_selector("#curves .scatterlayer")
    assert chromium_page.evaluate("document.documentElement.scrollWidth") <= 390
    paper, ink = chromium_page.evaluate(
        "[getComputedStyle(document.body).backgroundColor, "
        "getComputedStyle(document.querySelector('.xtick text')).fill]"
    )
    bright = [sum(map(int, each[4:-1].split(","))) > 382 for each in (paper, ink)]
    assert bright == ([True, False] if scheme == "light" else [False, True])
    told = chromium_page.inner_text("body")
    assert "run_11.csv" in chromium_page.inner_text("#recording") and "ALARM" in told
    assert "The reference (4 s) determines these parameters less well" in told
    assert not errors


def test_a_notebook_shows_the_last_recording_alone(watched):
    result = WatchResult(watched, [])
    shown = result.in_short()
    assert list(shown.index) == [LEAKAGE, DROOP] and shown["gain"].is_monotonic_decreasing
    told = result._repr_html_()
    assert "Alarm since" in told and "sha256" not in told and told.count(">joint<") == 2 + 1


def test_lines_of_a_plot_are_told_apart(chromium_page, address):
    chromium_page.goto(address)
    chromium_page.wait_for_selector(".scatterlayer")
    colours = chromium_page.evaluate(
        "[...document.querySelector('.js-plotly-plot').data].map("
        "t => (t.marker && t.marker.color) || t.line.color || t.fillcolor)"
    )
    assert len(set(colours)) >= len(colours) - 1  # a trend and its band are of one colour
