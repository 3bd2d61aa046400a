"""CSV files: comma, semicolon or tab separated, one header row."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.table import Column, Table

if TYPE_CHECKING:
    import pyarrow

_SEPARATORS = ",;\t"
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")


def read_csv(path: Path) -> Table:
    """Read a text file; empty cells are NaN, empty lines and lines that start with `#` are skipped.

    Where the separator is not a comma and no number has a decimal point, the comma is the decimal mark. Text
    is UTF-8 or, with a byte order mark, UTF-16; else it is taken for Windows-1252, which older measuring
    programs write.

    Raises:
        InputError: There is no header, or a row has another number of cells than the header.
    """
    from pyarrow import csv as arrow_csv
    from pyarrow import string

    text = _decoded(path)
    lines = [(number, line) for number, line in _numbered(text) if line.strip() and not line.startswith("#")]
    if not lines:
        raise InputError(f"{path} is empty; a recording needs a header row and samples")
    header_line = lines[0][1]
    separator = max(_SEPARATORS, key=header_line.count)
    names = [name.strip() for name in next(csv.reader([header_line], delimiter=separator))]
    if all(_is_number(name) for name in names):
        raise InputError(f"{path}: line {lines[0][0]} holds numbers; the first row must name the columns")
    body = lines[1:]
    if not body:
        raise InputError(f"{path} has a header but no rows")

    places = [str(place) for place in range(len(names))]
    wrong: list[str] = []

    def refuse(row: "arrow_csv.InvalidRow") -> str:
        wrong.append(row.text)
        return "error"

    try:
        table = arrow_csv.read_csv(
            io.BytesIO("\n".join(line for _, line in body).encode()),
            read_options=arrow_csv.ReadOptions(column_names=places, use_threads=False),
            parse_options=arrow_csv.ParseOptions(delimiter=separator, invalid_row_handler=refuse),
            convert_options=arrow_csv.ConvertOptions(
                column_types=dict.fromkeys(places, string()), strings_can_be_null=False
            ),
        )
    except Exception:
        if not wrong:
            raise
        number = next(
            (number for number, line in body if line.strip("\r") == wrong[0].strip("\r")), body[0][0]
        )
        raise InputError(
            f"{path}: line {number} has {_cells(wrong[0], separator)} cells; the header has {len(names)}"
        ) from None
    return Table(
        columns=tuple(
            Column((name,), _numbers_or_text(cells))
            for name, cells in zip(names, table.itercolumns(), strict=True)
            if name or _any_text(cells.to_numpy())
        ),
        row_name="line",
        rows=np.array([number for number, _ in body]),
        decimal_comma=separator != "," and not any(_decimal_point(separator, line) for _, line in body),
    )


def _numbers_or_text(cells: "pyarrow.ChunkedArray") -> np.ndarray:
    """A column as floats if every cell is plainly a number or empty, which is fast; else its text."""
    import pyarrow
    from pyarrow import compute

    try:
        filled = compute.if_else(compute.equal(cells, ""), pyarrow.scalar(None, pyarrow.string()), cells)
        return filled.cast("float64").to_numpy()
    except pyarrow.ArrowInvalid:
        return cells.to_numpy()


def _decoded(path: Path) -> str:
    data = path.read_bytes()
    if data.startswith(_UTF16_MARKS):
        return data.decode("utf-16")
    if b"\0" in data:
        raise InputError(f"{path} is not a text file; a CSV recording holds plain text")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252")


def _numbered(text: str) -> Iterator[tuple[int, str]]:
    """Lines with their number; only newlines end a line, as in every editor."""
    yield from enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), start=1)


def _cells(line: str, separator: str) -> int:
    return len(next(csv.reader([line], delimiter=separator)))


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _decimal_point(separator: str, line: str) -> bool:
    """Whether a cell is a number with a decimal point; a date such as 01.02.2024 is not."""
    return "." in line and any("." in cell and _is_number(cell) for cell in line.split(separator))


def _any_text(cells: np.ndarray) -> bool:
    return any(cell.strip() for cell in cells)
