"""docs/reference/effects.md is the catalogue."""

from pathlib import Path

from hydrolek_drake.effects import EFFECTS, HOOKS
from hydrolek_drake.effects.document import effects_markdown

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "effects.md"


def test_the_page_is_current():
    assert PAGE.read_text(encoding="utf-8") == effects_markdown(), (
        "docs/reference/effects.md is old; it says how to write it"
    )


def test_the_page_holds_every_effect_parameter_and_hook():
    page = effects_markdown()
    for effect in EFFECTS.values():
        section = page.split(f"\n## {effect.id}\n")[1].split("\n## ")[0]
        assert effect.equation in section and effect.source in section
        assert all(f"`{p.name}`" in section for p in effect.parameters)
        assert all(f"`{other}`" in section for other in effect.confused_with)
    assert all(f"| `{hook}` |" in page for hook in HOOKS)
    assert "## How to add an effect: one file and one test" in page


def test_every_line_of_the_effects_table_leads_to_a_heading():
    page = effects_markdown()
    anchors = {
        line[3:].lower().replace(".", "").replace(" ", "-") for line in page.splitlines() if line[:3] == "## "
    }
    linked = {line.split("](#")[1].split(")")[0] for line in page.splitlines() if line.startswith("| [`")}
    assert linked and linked <= anchors
