"""The commands of the pages, run as they are printed, page by page in their order, on recordings of the bench."""

import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
CONSOLE = re.compile(r"^ *```console\n(.*?)^ *```", re.MULTILINE | re.DOTALL)
LONGEST_S = 900.0

ELSEWHERE = {
    "control bench --plant full": "tests/control/test_controlled_station.py",
    "control judge": "tests/cli/test_control.py",
    "control tune": "tests/cli/test_control.py",
    "diagnose crane.yaml": "tests/fmu/test_plants_of_a_challenge.py",
    "fit joint_bench train.csv --method de --cluster": "tests/identification/search/test_workers.py",
    "fmu record crane.fmu": "tests/fmu/test_foreign_units.py",
    "fmu show crane.fmu": "tests/fmu/test_foreign_units.py",
    "identify sdp steps": "tests/identification/test_sdp.py",
    "identify two-step hydrolek_right_j2 a.csv": "tests/identification/test_two_step.py",
    "rig check my_axis.yaml": "tests/checking",
    "rigs my_axis.yaml": "tests/robustness",
    "stand docs/examples/site.yaml --grasping right --base room.yaml": "tests/standing",
    "teleop": "tests/teleop",
    "vision FOLDER": "tests/cli/test_vision_command.py",
    "vision live": "tests/cli/test_vision_command.py",
    "vision realsense": "tests/cli/test_vision_command.py",
    "vision recording.db3": "tests/cli/test_vision_command.py",
    "watch joint_bench healthy_1.csv healthy_2.csv healthy_3.csv --live": "tests/watching/test_live_following.py",
}
"""How commands begin that need a camera, a machine, a cluster, a person or hours, and what tests these."""

STATUS = {
    r"simulate$": 2,
    r"ik right --position 3 0 0$": 2,
    r"stand --pipe-point 2 0 3.5$": 2,
    r"watch ": 3,
}
"""Commands that end with another exit status than 0: no answer, and an alarm."""

STAYS = {"simulate hose_burst --meshcat": "open http", "show out/both_arms": "open http"}
"""How commands begin that go on until Ctrl-C, and what they tell before."""

INTERRUPTED = 130

FIRST = DOCS / "start" / "first_diagnosis.md"
FOUND = re.compile(r"^missing_physics:.*?(?=\nreport: |\n```)", re.MULTILINE | re.DOTALL)
"""What that page and the README show of a diagnosis, with dots where something is left out."""

TOLD = ("hydrolek: ", "wrote ")
"""How lines of what is shown below a command begin that do not depend on the recordings."""


def _of(page: Path) -> list[tuple[str, list[str]]]:
    """Commands of a page that are run here, and the lines shown below each."""
    found: list[tuple[str, list[str]]] = []
    for block in CONSOLE.findall(page.read_text(encoding="utf-8")):
        for line in re.sub(r"\\\n\s*", "", block).splitlines():
            text = line.strip()
            if text.startswith("$ "):
                found.append((text[2:], []))
            elif found:
                found[-1][1].append(text)
    own = [(line.removeprefix("hydrolek "), below) for line, below in found if line.startswith("hydrolek ")]
    return [(line, below) for line, below in own if not line.startswith(tuple(ELSEWHERE))]


PAGES = [
    page
    for page in sorted(DOCS.rglob("*.md"))
    if not {"evidence", "generated"} & set(page.relative_to(DOCS).parts) and _of(page)
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """With the files that the pages name."""
    bench = ROOT / "tests" / "data" / "bench"
    for name, source in {
        "train.csv": "practice_04/train.csv",
        "holdout.csv": "practice_04/holdout.csv",
        "a.csv": "practice_01/train.csv",
        "b.csv": "practice_01/holdout.csv",
        "healthy_1.csv": "practice_01/train.csv",
        "healthy_2.csv": "practice_01/holdout.csv",
        "healthy_3.csv": "practice_02/train.csv",
        "runs/1.csv": "practice_04/train.csv",
        "runs/2.csv": "practice_04/holdout.csv",
    }.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(bench / source, tmp_path / name)
    for rig in ("fitted.yaml", "out/fit/rig_fitted.yaml"):
        (tmp_path / rig).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / rig).write_text("schema: 1\nname: fitted\ntitle: fitted\nbased_on: joint_bench\n")
    (tmp_path / "docs").symlink_to(DOCS)
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    return tmp_path


def _done(line: str, folder: Path, stays: str | None) -> tuple[int, str]:
    """Exit status of a command and what it told; one that stays is interrupted once it told that.

    The shell of a background job has its programs ignore Ctrl-C, which is undone here.
    """
    command = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "from hydrolek_drake.cli.app import main; main()",
            *shlex.split(line, comments=True),
        ],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    before = ""
    try:
        if stays is not None:
            assert command.stdout is not None
            for told in command.stdout:
                before += told
                if stays in told:
                    break
            command.send_signal(signal.SIGINT)
        after, _ = command.communicate(timeout=LONGEST_S)
    finally:
        command.kill()
    return command.returncode, before + after


def _shown(page: Path) -> list[str]:
    """What a page shows of the first diagnosis, without regard to where lines are broken."""
    [found] = FOUND.findall(page.read_text(encoding="utf-8"))
    return [" ".join(part.split()) for part in re.split(r"^\.\.\.$", found, flags=re.MULTILINE)]


@pytest.mark.long("a quarter of an hour in all: whole commands")
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_commands_of_a_page_do_what_it_says(page, folder):
    for line, below in _of(page):
        words = shlex.join(shlex.split(line, comments=True))
        wanted = next((status for pattern, status in STATUS.items() if re.match(pattern, words)), 0)
        stays = next((words for begins, words in STAYS.items() if line.startswith(begins)), None)
        status, told = _done(line, folder, stays)
        assert status in ((wanted,) if stays is None else (0, INTERRUPTED)), f"{line}\n{told[-2000:]}"
        for shown in below:
            if shown.startswith(TOLD):
                assert shown.partition("...")[0].strip() in told, line
        if page == FIRST and line.startswith("diagnose"):
            plain = " ".join(told.split())
            for part in [
                *_shown(page),
                *_shown(ROOT / "README.md"),
            ]:  # the demo diagnoses the same recordings
                assert part in plain


def test_what_tests_the_other_commands_is_there():
    assert not {where for where in ELSEWHERE.values() if not (ROOT / where).exists()}
