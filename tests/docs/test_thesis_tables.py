"""Tables of the documents that compare with the thesis are those that `scripts/thesis_tables.py` makes today."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def _tables():
    specification = importlib.util.spec_from_file_location(
        "thesis_tables", ROOT / "scripts" / "thesis_tables.py"
    )
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return list(module.tables())


@pytest.mark.parametrize(
    ("page", "title", "lines"), _tables(), ids=lambda value: value if isinstance(value, str) else ""
)
def test_a_table_stands_in_its_page(page, title, lines):
    assert len(lines) > 5
    assert "\n".join(lines) in (ROOT / "docs" / page).read_text(encoding="utf-8"), title
