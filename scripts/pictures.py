"""The documentation's pictures, made new.

python scripts/pictures.py [NAME ...]      # such as kinematics or replay/replay; all if none is named: an hour and more
python scripts/pictures.py --list          # by what each is made

Most are what a command of the guides writes; pages are taken in a headless browser (Playwright and Chromium).
"""

import argparse
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
BENCH = ROOT / "tests" / "data" / "bench"
PAIR_1, PAIR_4 = (
    f"joint_bench {BENCH / pair / 'train.csv'} --holdout {BENCH / pair / 'holdout.csv'}"
    for pair in ("practice_01", "practice_04")
)
ARM_JOINTS = range(1, 6)
READY_MS, DRAWN_MS = 120e3, 2000
"""How long a page may take, and its plots."""

REPLAY_AT_S = 5.25
"""Moment of the 3-D replay that is shown."""

FADED = 40
"""Per cent to which the report's effect is faded."""


@dataclass(frozen=True)
class Page:
    """What is taken of a page.

    Attributes:
        file: in the folder that the command writes.
        width: of the window [pixels].
        height: of what is taken [pixels].
        ready: script that is run first.
    """

    file: str
    width: int
    height: int
    ready: str = ""


@dataclass(frozen=True)
class Made:
    """Pictures that one command makes.

    Attributes:
        command: arguments of `hydrolek` or, with a program or a module first, of Python; OUT is the folder it writes.
        pictures: name below docs/pictures -> file in that folder, or part of a page.
        environment: of the command, beside what is set.
    """

    command: str
    pictures: dict[str, str | Page]
    environment: tuple[tuple[str, str], ...] = ()


FADE = (
    "const slider = document.querySelector('input[type=range]');"
    f"slider.value = {FADED} * slider.max / 100; slider.dispatchEvent(new Event('input', {{bubbles: true}}));"
)
SEEK = (
    f"viewer.animator.pause(); viewer.animator.seek({REPLAY_AT_S});"
    "viewer.camera.zoom = 1.4; viewer.camera.setViewOffset(950, 520, 150, -80, 950, 520); viewer.set_dirty();"
)

MADE = (
    Made(f"diagnose {PAIR_4} --out OUT", {"diagnosis/diagnosis": Page("report.html", 1200, 1660, FADE)}),
    Made(f"replay joint_bench {BENCH / 'practice_03/train.csv'} --out OUT", {"replay/replay": "replay.png"}),
    Made(
        "simulate both_arms --out OUT",
        {"simulation/simulate": Page("replay3d.html", 950, 520, SEEK)},
    ),
    Made("scripts/pictures.py --arms OUT", {"simulation/arms": "arms.png"}),
    Made("stand docs/examples/site.yaml --out OUT", {"kinematics/stand": "stand.png"}),
    Made("carry --out OUT", {"kinematics/carry": "carry.png"}),
    Made(
        "control bench --controller fuzzy_appendix_f --out OUT",
        {"control/fuzzy_appendix_f_j2": "fuzzy_appendix_f_j2.png"},
    ),
    Made("control bench --plant full --sequence step --out OUT", {"control/control_step": "step.png"}),
    Made("control bench --plant full --sequence grasp --out OUT", {"control/grasp_path": "grasp_path.png"}),
    Made(
        "identify sdp --rig hydrolek_right_j2 --fine --out OUT",
        {"identification/sdp_right_j2": "sdp_right_j2.png"},
    ),
    Made(
        "sensitivity hydrolek_right_j2 --out OUT",
        {"identification/sensitivity_right_j2": "sensitivity_right_j2.png"},
    ),
    Made(
        "sensitivity hydrolek_right_j2 --surface valve.discharge cylinder.area_a --out OUT",
        {"identification/performance_surface": "surface_right_j2.png"},
    ),
    Made(
        f"sensitivity joint_bench {BENCH / 'practice_01/train.csv'} --sobol 64 --out OUT",
        {"identification/sobol_bench": "sensitivity_joint_sobol.png"},
    ),
    Made(
        f"fit {PAIR_1} --profile command.delay --profile valve.max_area_a --profile load.inertia --out OUT",
        {"identification/profiles": "profiles.png"},
    ),
    *(
        Made(
            f"identify two-step hydrolek_right_j{joint} --seed 1 --out OUT",
            {f"identification/two_step_right_j{joint}": f"two_step_right_j{joint}.png"},
        )
        for joint in ARM_JOINTS
    ),
    Made(
        "scripts/genetic_study.py --runs 10 --seed 1 --out OUT",
        {
            f"identification/learning_{name}": f"pictures/learning_{name}.png"
            for name in ("coding", "crossover", "fitness")
        },
    ),
    Made(
        "-m pytest --long -n 0 tests/teleop/browser/test_browser_hydraulic.py",
        {
            f"teleop/console_{name}": f"console_{name}.png"
            for name in ("charts", "confirm", "hand", "moving", "trial", "view")
        },
        (("HYDROLEK_PICTURES", "OUT"),),
    ),
    Made(
        "scripts/watching/watch_pictures.py --out OUT --guide OUT",
        {"watching/watch": "watch.png", "watching/watch_live": "watch_live.png"},
    ),
)

COMPOSED = {
    "vision/vision_recorded": "two frames of the Object Segmentation Database, by `hydrolek vision FOLDER`",
    "vision/vision_simulated": "what `hydrolek vision sim` writes, beside the depth",
    "vision/vision_unsure": "two tables of `vision_study.py --clutter`, by `hydrolek vision` and `--other`",
}
"""Put together by hand of what commands write."""


def made(one: Made, out: Path, wanted: Callable[[str], bool]) -> None:
    """Run a command and keep its pictures.

    Args:
        one: command and pictures.
        out: the folder that it writes.
        wanted: whether a picture is to be kept, by its name.
    """
    words = [word.replace("OUT", str(out)) for word in shlex.split(one.command)]
    ours = words[0].endswith(".py") or words[0] == "-m"
    program = [sys.executable] if ours else [str(Path(sys.executable).parent / "hydrolek")]
    more = {name: value.replace("OUT", str(out)) for name, value in one.environment}
    subprocess.run([*program, *words], cwd=ROOT, check=True, env={**os.environ, **more})
    for name, source in one.pictures.items():
        if wanted(name):
            target = (PICTURES / name).with_suffix(".png")
            if isinstance(source, Page):
                taken(out / source.file, source, target)
            else:
                shutil.copy(out / source, target)
            print(target.relative_to(ROOT))


def taken(file: Path, page: Page, target: Path) -> None:
    """A part of a page as a picture.

    Args:
        file: the page.
        page: how it is shown.
        target: the picture.
    """
    from playwright.sync_api import sync_playwright

    names = ("chromium", "chromium-browser", "google-chrome")
    with sync_playwright() as engine:
        browser = engine.chromium.launch(
            executable_path=next(filter(None, map(shutil.which, names))),
            args=["--no-sandbox"] if os.geteuid() == 0 else [],
        )
        shown = browser.new_page(viewport={"width": page.width, "height": page.height}, color_scheme="light")
        shown.goto(file.absolute().as_uri(), timeout=READY_MS)
        shown.wait_for_timeout(DRAWN_MS)
        if page.ready:
            shown.evaluate(page.ready)
            shown.wait_for_timeout(DRAWN_MS)
        shown.screenshot(path=target)
        browser.close()


def arms(out: Path) -> None:
    """The README's picture of both arms."""
    from hydrolek_drake.visualization.pictures import render_scene, write_picture

    write_picture(out / "arms.png", render_scene())


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="pictures, or folders of them")
    parser.add_argument("--list", action="store_true", help="say by what each is made, and end")
    parser.add_argument("--arms", type=Path, metavar="DIR", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.arms is not None:
        return arms(given.arms)
    if given.list:
        for one in MADE:
            print(f"{one.command.replace(f'{ROOT}/', '')}: {', '.join(one.pictures)}")
        for name, how in COMPOSED.items():
            print(f"by hand, {how}: {name}")
        return None

    def wanted(name: str) -> bool:
        return not given.names or any(name == own or name.startswith(f"{own}/") for own in given.names)

    for one in MADE:
        if any(map(wanted, one.pictures)):
            with tempfile.TemporaryDirectory() as folder:
                made(one, Path(folder), wanted)
    return None


if __name__ == "__main__":
    main()
