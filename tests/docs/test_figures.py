"""Figures that the documents repeat agree with where they come from, and nothing built is called unbuilt."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml

ROOT = Path(__file__).parents[2]
FIGURES = yaml.safe_load((ROOT / "docs" / "evidence" / "data" / "figures.yaml").read_text(encoding="utf-8"))
PAGES = [*sorted((ROOT / "docs").rglob("*.md")), ROOT / "README.md"]


def _values(tree, key):
    if not key:
        return [tree]
    name, _, rest = key.partition(".")
    if name.endswith("[*]"):
        return [value for each in tree[name[:-3]] for value in _values(each, rest)]
    return _values(tree[name], rest) if name in tree else []


def value_of(source):
    """The figure, from a YAML or JSON file."""
    text = (ROOT / source["file"]).read_text(encoding="utf-8")
    tree = json.loads(text) if source["file"].endswith(".json") else yaml.safe_load(text)
    values = [value for value in _values(tree, source["key"]) if value is not None]
    assert values, f"{source['file']} has no {source['key']}"
    if "take" in source:
        return float(getattr(np, source["take"])(values))
    assert len(values) == 1
    return values[0]


def _joined(path):
    return " ".join(path.read_text(encoding="utf-8").split())


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure["from"]["key"])
def test_a_figure_stands_in_the_documents_as_its_source_has_it(figure):
    value = value_of(figure["from"])
    for page, sentences in figure["stands"].items():
        text = _joined(ROOT / page)
        for sentence in sentences:
            assert sentence.format(value) in text, f"{page} does not say '{sentence.format(value)}'"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_page_calls_unbuilt_what_is_built(page):
    found = re.findall(r"[^.|]*\bnot (?:yet )?(?:built|implemented)(?: yet)?\b[^.|]*", _joined(page))
    assert not found, f"{page.name}: say what is missing and why: {found}"
