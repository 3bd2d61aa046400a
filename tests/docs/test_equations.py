"""docs/reference/equations.md is complete and true: every number is there, every name and command exists."""

import ast
import importlib
import re
from functools import cache
from pathlib import Path

import pytest
import typer

from hydrolek_drake.cli.app import COMMANDS

ROOT = Path(__file__).parents[2]
EQUATIONS = [
    *(f"(3.{n})" for n in range(1, 4)),
    *(f"(4.{n})" for n in range(1, 20)),
    *(f"(5.{n})" for n in range(1, 8)),
    *(f"(6.{n})" for n in range(1, 21)),
    "(C.1)",
    "(D.1)",
]
TABLES = [
    f"Table {chapter}.{n}"
    for chapter, count in (("3", 2), ("4", 10), ("5", 4), ("6", 11), ("7", 5), ("A", 1), ("G", 11))
    for n in range(1, count + 1)
]
FIGURES = [
    f"{chapter}.{n}"
    for chapter, count in (
        ("1", 1), ("3", 2), ("4", 23), ("5", 9), ("6", 28), ("7", 15), ("B", 9), ("E", 8), ("F", 4),
    )
    for n in range(1, count + 1)
]  # fmt: skip


def _each(numbers):
    """ "(5.5) to (5.7)" as (5.5), (5.6), (5.7); "Table G.7 to G.11" likewise."""
    first, _, last = numbers.partition(" to ")
    if not last:
        return [numbers]
    before, start, after = re.fullmatch(r"(.*?)(\d+)(\)?)", first).groups()
    end = int(re.search(r"\d+(?=\)?$)", last)[0])
    assert before.endswith(".") and last == f"{before.removeprefix('Table ')}{end}{after}"
    return [f"{before}{n}{after}" for n in range(int(start), end + 1)]


def _rows(part, header):
    page = ROOT / "docs" / "reference" / "equations.md"
    lines = page.read_text(encoding="utf-8").split("## Figures")[part]
    cells = [
        [cell.strip() for cell in line.strip("|").split(" | ")]
        for line in lines.splitlines()
        if line.startswith("| ")
    ]
    assert cells[0] == header
    return {row[0]: row for row in cells[1:]}


def _by_number(rows):
    return {number: row for numbers, row in rows.items() for number in _each(numbers)}


ROWS = _by_number(_rows(0, ["Number", "What", "File", "Function", "Test"]))
FIGURE_ROWS = _rows(1, ["Figures", "Content", "Drawn by"])
BUILT = [number for number, row in ROWS.items() if "`" in row[2]]


def _names(cell):
    return re.findall(r"`([^`]+)`", cell)


@cache
def _defined(path):
    """Names of functions, classes and constants that a Python file defines at its top level."""
    names = set()
    for node in ast.parse((ROOT / path).read_text(encoding="utf-8")).body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, ast.Assign):
            names.update(target.id for target in node.targets if isinstance(target, ast.Name))
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names.add(node.target.id)
    return names


def test_the_table_holds_every_equation_and_table_of_the_thesis_in_order_and_nothing_else():
    assert list(ROWS) == EQUATIONS + TABLES


@pytest.mark.parametrize("number", ROWS)
def test_a_row_says_where_it_lives_or_that_it_does_not_and_why(number):
    _, what, file, function, test = (cell.strip() for cell in ROWS[number])
    assert what
    if number in BUILT:
        assert _names(test)
        assert _names(function) or not any(name.endswith(".py") for name in _names(file))
    else:
        assert re.fullmatch(r"not reproducible because .+", file)
        assert (function, test) == ("-", "-")


@pytest.mark.parametrize("number", BUILT)
def test_every_file_function_and_test_that_is_named_exists(number):
    _, _, files, functions, tests = ROWS[number]
    for file in _names(files):
        assert (ROOT / file).is_file(), file
    defined = set().union(*(_defined(file) for file in _names(files) if file.endswith(".py")), set())
    assert set(_names(functions)) <= defined
    for test in _names(tests):
        file, name = test.split("::")
        assert name in _defined(file), test


def _numbers(text):
    """ "4.6 to 4.8, B.1" as 4.6, 4.7, 4.8, B.1."""
    for part in text.split(", "):
        first, _, last = part.partition(" to ")
        chapter, number = first.split(".")
        end = int(last.removeprefix(f"{chapter}.")) if last else int(number)
        assert end >= int(number)
        yield from (f"{chapter}.{n}" for n in range(int(number), end + 1))


def test_every_figure_of_the_thesis_is_listed_once():
    listed = [number for row in FIGURE_ROWS for number in _numbers(row)]
    assert sorted(listed) == sorted(FIGURES)


def _command(words):
    """The click command that words name, such as ["control", "bench"]."""
    entry = COMMANDS[words[0]]
    found = getattr(importlib.import_module(entry.module), entry.attribute)
    if isinstance(found, typer.Typer):
        command = typer.main.get_command(found)
        for word in words[1:]:
            command = command.commands[word]
        return command
    assert len(words) == 1
    app = typer.Typer()
    app.command()(found)
    return typer.main.get_command(app)


@pytest.mark.parametrize("figures", FIGURE_ROWS)
def test_what_draws_a_figure_exists_with_the_options_that_are_named(figures):
    _, content, drawn = FIGURE_ROWS[figures]
    assert content
    if drawn.startswith("none: "):
        return
    assert _names(drawn)
    for name in _names(drawn):
        words = [word for word in name.split() if not word.startswith("--")]
        options = {word for word in name.split() if word.startswith("--")}
        if words[0] == "hydrolek":
            has = {option for parameter in _command(words[1:]).params for option in parameter.opts}
            assert options <= has, name
        else:
            source = (ROOT / words[0]).read_text(encoding="utf-8")
            assert all(f'"{option}"' in source for option in options), name


def test_only_what_is_no_result_or_has_no_counterpart_is_drawn_by_nothing():
    """A figure is left out for being a photograph or a schematic, or for a physical reason that is named."""
    undrawn = {row: cells for row, cells in FIGURE_ROWS.items() if cells[2].startswith("none: ")}
    for _, content, drawn in undrawn.values():
        assert re.search(r"photograph|no result|gravity", content + drawn)
    assert not {"4.11", "5.9", "7.11"} & {number for row in undrawn for number in _numbers(row)}


def _cited():
    """(file, number) of every equation that a docstring of the package cites in parentheses."""
    for path in sorted((ROOT / "hydrolek_drake").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
                for number in re.findall(r"\((?:[3-6]|C|D)\.\d+\)", ast.get_docstring(node) or ""):
                    yield path.relative_to(ROOT).as_posix(), number


CITED = sorted(set(_cited()))


def test_docstrings_do_cite_equations():
    assert ("hydrolek_drake/physics/amplifier.py", "(4.4)") in CITED


@pytest.mark.parametrize(("file", "number"), CITED)
def test_an_equation_cited_in_a_docstring_is_listed_as_living_there(file, number):
    assert number in ROWS, f"{file} cites {number}, which the thesis does not have"
    assert file in _names(ROWS[number][2])
