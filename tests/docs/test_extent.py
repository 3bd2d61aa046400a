"""Documentation stays as long as one reads, folders as full as one oversees, and evidence says what it comes from."""

import re
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
EVIDENCE = sorted((DOCS / "evidence").glob("*.md"))
WRITTEN_BY_CODE = {DOCS / "reference" / "effects.md"}
"""Beside what is generated when the site is built."""

LINES, TERMS, FILES = 2000, 40, 25
"""At most of the pages that are written by hand, of the glossary, and of a folder without subfolders."""

DATE = re.compile(r"\b20\d\d-\d\d-\d\d\b")
COMMIT = re.compile(r"\b(?=[0-9a-f]*\d)[0-9a-f]{7,8}\b")
COMMAND = re.compile(r"^\$ |`[^`]*(?:hydrolek |scripts/|pytest |\.py)[^`]*`|\.ci/run", re.MULTILINE)
READ = "side_by_side.md"
"""What was read of others has no command, and the commits are theirs."""

TABLES = "genetic_study_tables.md"
"""Written by the command of `genetic_study.md`, which says of which commit."""


def test_what_is_written_by_hand_can_be_read():
    pages = [
        page
        for page in DOCS.rglob("*.md")
        if page not in {*EVIDENCE, *WRITTEN_BY_CODE} and "generated" not in page.parts
    ]
    assert sum(len(page.read_text(encoding="utf-8").splitlines()) for page in pages) <= LINES


def test_the_glossary_is_short():
    lines = (DOCS / "concepts" / "glossary.md").read_text(encoding="utf-8").splitlines()
    assert len([line for line in lines if line.startswith("| ")]) - 1 <= TERMS  # the first is the heading


@pytest.mark.parametrize("top", ["hydrolek_drake", "scripts", "tests", "docs"])
def test_a_folder_with_many_files_has_subfolders(top):
    files = [p for p in (ROOT / top).rglob("*") if p.is_file() and "__pycache__" not in p.parts]
    full = {folder for folder, count in Counter(p.parent for p in files).items() if count > FILES}
    flat = {f for f in full if not any(p.parent != f and f in p.parents for p in files)}
    assert not flat


@pytest.mark.parametrize("page", [p for p in EVIDENCE if p.name != TABLES], ids=lambda page: page.name)
def test_evidence_says_by_what_command_when_and_of_which_commit_it_is(page):
    text = page.read_text(encoding="utf-8")
    assert DATE.search(text)
    assert COMMIT.search(text)
    assert COMMAND.search(text) or page.name == READ
