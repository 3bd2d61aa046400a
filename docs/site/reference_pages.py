"""Reference pages that are generated when the site is built: commands from typer, rig files from their JSON schema."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import typer
from sphinx.application import Sphinx
from typer.cli import get_docs_for_click

from hydrolek_drake.cli.app import COMMANDS, typer_app
from hydrolek_drake.diagnosis.report.schema import report_schema
from hydrolek_drake.rigs.reading.json_schema import rig_schema

FOLDER = Path(__file__).parents[1] / "reference" / "generated"


def commands_page() -> str:
    """Every command with its arguments and options, as typer knows them."""
    parts = [
        "# Commands\n",
        "Bad input is answered with one line and exit status 2, an interrupt with 130, an alarm of `watch` with 3.\n",
    ]
    for name in COMMANDS:
        command = typer.main.get_command(typer_app(name))
        context = typer.Context(command, info_name=f"hydrolek {name}")
        parts.append(get_docs_for_click(obj=command, ctx=context, name=f"hydrolek {name}", indent=1))
    return "\n".join(parts)


def rig_page() -> str:
    """Every key of a rig file, by stage and variant."""
    schema = rig_schema()
    shared = {k: v for k, v in schema["properties"].items() if "variant" in v.get("properties", {})}
    joint = schema["properties"]["joints"]["additionalProperties"]["properties"]
    stages = {k: v for k, v in joint.items() if "variant" in v.get("properties", {})}
    lines = [
        "# Rig files\n",
        "What stands in a rig file. Every number is written as `{value, unit, source}`, and with `range` and `scale`",
        "where a fit may change it. `hydrolek rig schema` prints the JSON schema, with which editors complete and",
        "check.",
        "How to write one: [your own machine](../../guides/own_machine.md). Effects: [the catalogue](../effects.md).\n",
        "## The file\n",
        "| key | holds |",
        "|---|---|",
    ]
    for key, value in schema["properties"].items():
        lines.append(f"| `{key}` | {_cell(value.get('description', _kind(value)))} |")
    lines += ["", "## Shared by all joints", ""]
    for name, stage in shared.items():
        lines += _stage_of(name, stage)
    lines += ["## Of each joint", "", "Under `joints.NAME`.", ""]
    for name, stage in stages.items():
        lines += _stage_of(name, stage)
    return "\n".join(lines) + "\n"


def report_page() -> str:
    """Every key of `report.json`."""
    lines = [
        "# report.json\n",
        "What `hydrolek diagnose --out DIR` writes for programs, beside the report, the fitted rig and residuals.",
        "Keys may be added; those that are here stay. How to read them: [Reading a report](../../start/report.md).\n",
        "| key | type | meaning |",
        "|---|---|---|",
        *_keys("", report_schema()),
    ]
    return "\n".join(lines) + "\n"


def _keys(path: str, schema: Mapping[str, Any]) -> Iterator[str]:
    """The keys below a place in a schema, each as a line of a table."""
    items = schema.get("items")
    if isinstance(items, Mapping):
        yield from _keys(f"{path}[]", items)
    others = schema.get("additionalProperties")
    if isinstance(others, Mapping):
        yield from _keys(f"{path}.*", others)
    for key, value in schema.get("properties", {}).items():
        own = f"{path}.{key}".lstrip(".")
        yield f"| `{own}` | {_kind(value)} | {_cell(value.get('description', ''))} |"
        yield from _keys(own, value)


def _stage_of(name: str, stage: Mapping[str, Any]) -> Iterator[str]:
    variants = ", ".join(f"`{v}`" for v in stage["properties"]["variant"]["enum"])
    yield f"### `{name}`"
    yield ""
    yield f"Variants: {variants}."
    yield ""
    yield "| key | meaning |"
    yield "|---|---|"
    for key, value in stage["properties"].items():
        if key not in ("variant", "uses"):
            yield f"| `{key}` | {_cell(value.get('description', _kind(value)))} |"
    yield ""


def _kind(value: Mapping[str, Any]) -> str:
    kinds = value.get("type", "value")
    if "const" in value:
        return str(value["const"])
    if "enum" in value:
        return "text"
    return " or ".join(kinds) if isinstance(kinds, list) else str(kinds)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def write_pages(app: Sphinx | None = None) -> None:
    """Write the pages beside the others; those that are as they were stay untouched."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in (
        ("commands.md", commands_page()),
        ("rig_files.md", rig_page()),
        ("report.md", report_page()),
    ):
        page = FOLDER / name
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True}
