"""Pictures of the pages of a watch in a headless browser, light and dark, on a screen and on a phone.

python scripts/watching/watch_pictures.py --out out/pictures [--guide docs/pictures/watching]

A bench of the challenge whose piston leaks more from day to day is watched, and a stream of it with a gap, in which it
begins to leak, is followed live. Every picture says whether the page scrolls sideways. With --guide the guide's
pictures are written, too. Needs Playwright and Chromium.
"""

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

from hydrolek_drake.challenge.build import BENCH, build_of
from hydrolek_drake.challenge.cases import driven, with_concealed, write_played
from hydrolek_drake.challenge.drawing import SIZING_STEP_S, individual
from hydrolek_drake.rigs import load_rig

DAYS, BEGINS, SECONDS = 12, 4, 20.0
GROWTH = 1.0e-13
"""Of the leakage, a day [m^3/(s Pa)]."""

LIMIT = 1.5e-12
STREAM_S, GAP_S = 150.0, 3.0
SHOTS = [(width, scheme) for width in (1372, 390) for scheme in ("light", "dark")]
HEIGHT = 882
CLOCK_S = 1772668800.0


def recorded(build, machine, seed, path, seconds=SECONDS, begins=0.0, gap=None):
    """Write one recording, without what lies within a gap."""
    rng = np.random.default_rng(seed)
    done = driven(build, machine, "open", seconds, rng, build.noise, SIZING_STEP_S)
    missing = None if gap is None else (gap, gap + GAP_S)
    write_played(path, build, done, rng, begins=begins, gap=missing)


def recordings(folder):
    """Reference recordings, one a day, and streams of a healthy and of a leaking machine."""
    build, rng = build_of(load_rig(BENCH)), np.random.default_rng(7)
    healthy = build.nominal._replace(**individual(build, rng))

    def leaking(size):
        return with_concealed(healthy, {"cylinder.cross_port_leakage": {"conductance_m3_per_s_Pa": size}})

    (folder / "runs").mkdir(parents=True, exist_ok=True)
    for number in range(3):
        recorded(build, healthy, 10 + number, folder / f"healthy_{number + 1}.csv")
    for day in range(DAYS):
        machine = leaking(GROWTH * max(day - BEGINS + 1, 0))
        recorded(build, machine, 30 + day, folder / "runs" / f"run_2026-03-{day + 1:02d}.csv")
    recorded(build, healthy, 60, folder / "stream_healthy.csv", STREAM_S, CLOCK_S, STREAM_S - 40.0)
    recorded(build, leaking(4.0 * GROWTH), 61, folder / "stream_leaking.csv", STREAM_S, CLOCK_S)


def shoot(engine, address, name, out, ready, click=None):
    """One page in all its forms."""
    browser = engine.chromium.launch(
        executable_path=next(
            filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome")))
        ),
        args=["--no-sandbox"] if os.geteuid() == 0 else [],
    )
    for width, scheme in SHOTS:
        page = browser.new_page(viewport={"width": width, "height": HEIGHT}, color_scheme=scheme)
        errors = []
        page.on("pageerror", lambda error, errors=errors: errors.append(str(error)))
        page.goto(address)
        page.wait_for_selector(ready, timeout=120e3)
        if click:
            page.locator(click).last.click()
        page.wait_for_timeout(1500)
        path = out / f"{name}_{width}_{scheme}.png"
        page.screenshot(path=path, full_page=True)
        wide = page.evaluate("document.documentElement.scrollWidth")
        print(f"{path}: {'scrolls sideways to ' + str(wide) if wide > width else 'fits'}; errors {errors}")
        page.close()
    browser.close()


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--guide", type=Path, help="where the guide's pictures are written")
    given = parser.parse_args()
    data = given.out / "data"
    if not (data / "stream_leaking.csv").exists():
        recordings(data)
    references = [path.name for path in sorted(data.glob("healthy_*.csv"))]  # as a user types them
    out = given.out.absolute()
    command = [str(Path(sys.executable).parent / "hydrolek"), "watch", BENCH, *references]
    told = ["--limit", f"cylinder.cross_port_leakage={LIMIT}", "--out", str(out / "watch")]
    subprocess.run([*command, "--recordings", "runs", *told], check=False, cwd=data)
    with sync_playwright() as engine:
        address = (out / "watch" / "watch.html").as_uri()
        shoot(engine, address, "watch", given.out, ".js-plotly-plot .scatterlayer", "a[data-id]")
        for stream in ("healthy", "leaking"):
            kept = out / f"live_{stream}"
            shutil.rmtree(kept, ignore_errors=True)
            live = ["--live", f"stream_{stream}.csv", "--out", str(kept), "--port", "0"]
            with subprocess.Popen(
                [*command, *live], stdout=subprocess.PIPE, text=True, cwd=data
            ) as following:
                line = next(line for line in following.stdout if "http://" in line)
                ready = "#effects tr" if stream == "leaking" else "#counts dd"
                shoot(engine, re.search(r"http://\S+", line).group(), f"live_{stream}", given.out, ready)
                following.send_signal(signal.SIGTERM)
    if given.guide:
        for picture, name in (("watch", "watch"), ("live_leaking", "watch_live")):
            shutil.copy(given.out / f"{picture}_1372_light.png", given.guide / f"{name}.png")


if __name__ == "__main__":
    main()
