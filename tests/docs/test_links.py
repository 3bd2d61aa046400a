"""Links, pictures and commands of the documentation lead somewhere."""

import importlib.util
import os
import re
import shlex
from functools import cache
from pathlib import Path

import pytest
import typer

from hydrolek_drake.cli.app import COMMANDS, typer_app

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
GENERATED = DOCS / "reference" / "generated"
PAGES = [p for p in sorted(DOCS.rglob("*.md")) if GENERATED not in p.parents]
PAGES += [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
LINK = re.compile(r"(!?)\[[^\]]*\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
CONSOLE = re.compile(r"^```console\n(.*?)^```", re.MULTILINE | re.DOTALL)


def _text(page: Path) -> str:
    return page.read_text(encoding="utf-8")


@cache
def _anchors(page: Path) -> frozenset[str]:
    """What headings are linked to by: lower case, no punctuation, hyphens for blanks; the second of a name has -1."""
    found: dict[str, int] = {}
    anchors = set()
    for line in FENCE.sub("", _text(page)).splitlines():
        if (match := re.match(r"#{1,6} (.*)", line)) is None:
            continue
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", match[1]).replace("`", "")
        slug = re.sub(r"[^\w\- ]", "", plain.strip().lower()).replace(" ", "-")
        anchors.add(slug if slug not in found else f"{slug}-{found[slug]}")
        found[slug] = found.get(slug, 0) + 1
    return frozenset(anchors)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_somewhere(page):
    broken = []
    for _, target in LINK.findall(FENCE.sub("", _text(page))):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if GENERATED in file.parents:
            continue  # written when the site is built, which refuses links that lead nowhere
        if not file.exists() or (anchor and file.suffix == ".md" and anchor not in _anchors(file)):
            broken.append(target)
    assert not broken


def test_every_picture_is_shown():
    shown = {
        (page.parent / target).resolve()
        for page in PAGES
        for mark, target in LINK.findall(_text(page))
        if mark
    }
    assert not set((DOCS / "pictures").rglob("*.png")) - shown


def test_every_picture_is_made_by_the_script():
    spec = importlib.util.spec_from_file_location("pictures", ROOT / "scripts" / "pictures.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    made = {name for one in script.MADE for name in one.pictures} | set(script.COMPOSED)
    pictures = DOCS / "pictures"
    assert made == {str(p.relative_to(pictures).with_suffix("")) for p in pictures.rglob("*.png")}


def test_every_page_is_in_the_site():
    index = _text(DOCS / "index.md")
    listed = set(re.findall(r"^[^<\n]+ <([\w/]+)>$", index, re.MULTILINE))
    apart = {"index", *(str(p.relative_to(DOCS).with_suffix("")) for p in (DOCS / "evidence").glob("*.md"))}
    pages = {str(p.relative_to(DOCS).with_suffix("")) for p in PAGES if DOCS in p.parents}
    assert pages <= listed | apart
    assert "evidence/*" in index


def _commands():
    """Every command line that a page shows, and where."""
    for page in PAGES:
        for block in CONSOLE.findall(_text(page)):
            for line in re.sub(r"\\\n\s*", "", block).splitlines():
                line = line.removeprefix("$ ")
                if re.match(r"hydrolek\s", line):
                    yield page, line


@pytest.mark.parametrize(
    ("page", "line"), list(_commands()), ids=lambda value: value[:50] if isinstance(value, str) else ""
)
def test_a_command_and_its_options_exist(page, line):
    words = shlex.split(line, comments=True)[1:]
    words = words[: next((i for i, word in enumerate(words) if word in ("|", "&&", ";", ">", "&")), None)]
    if words[0].startswith("--"):
        assert words[0] in ("--help", "--version")
        return
    assert words[0] in COMMANDS
    command = typer.main.get_command(typer_app(words[0]))
    rest = words[1:]
    while hasattr(command, "commands"):
        if rest and rest[0] in command.commands:
            command, rest = command.commands[rest[0]], rest[1:]
        else:
            assert not [word for word in rest if not word.startswith("-")], f"no such subcommand: {rest[0]}"
            break
    if command.context_settings.get("ignore_unknown_options"):
        return  # what a data sheet says; tests/rigs/test_wizard.py runs these
    known = {name for option in command.params for name in (*option.opts, *option.secondary_opts)} | {
        "--help"
    }
    given = [word.split("=")[0] for word in rest if re.match(r"--?[a-zA-Z]", word)]
    assert set(given) <= known


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_script_that_is_named_exists(page):
    named = set(re.findall(r"\bscripts/[a-z_]+(?:\.[a-z]+)?\b", _text(page)))
    assert not {name for name in named if not os.path.exists(ROOT / name)}
