"""docs/equations.md is complete and true: every number is there, and every name it gives exists."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

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


def _rows():
    lines = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8").splitlines()
    cells = [
        [cell.strip() for cell in line.strip("|").split(" | ")] for line in lines if line.startswith("| ")
    ]
    assert cells[0] == ["Number", "What", "File", "Function", "Test"]
    return {row[0]: row for row in cells[1:]}


ROWS = _rows()
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
        assert re.fullmatch(r"not yet: .+|not needed because .+", file)
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
