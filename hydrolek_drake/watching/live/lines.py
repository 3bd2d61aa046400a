"""Samples as lines of text: a recording's CSV, line by line, whether from a file that grows or over TCP.

A line whose cells are no numbers names the columns, as in a recording; every other line is a sample with as many cells,
empty where there is no value. Empty lines and lines that begin with `#` say nothing.
"""

import csv
from collections.abc import Mapping, Sequence

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.columns import IGNORE, TIME, ColumnName, parse_column
from hydrolek_drake.watching.live.samples import Samples

_SEPARATORS = ",;\t"


class LineReader:
    """Turns lines into samples.

    Attributes:
        bad: lines so far that are no samples.
        bad_in_a_row: of these, the last ones.
        last_bad: why the last of them is none.
    """

    def __init__(self, columns: Mapping[str, str], source: str) -> None:
        """Prepare.

        Args:
            columns: contract name by name of a column, from the rig.
            source: for messages.
        """
        self._mapping, self._source = columns, source
        self.bad, self.bad_in_a_row, self.last_bad = 0, 0, ""
        self._separator, self._cells = ",", 0
        self._used: list[tuple[int, ColumnName]] = []
        self._begins = True

    def restart(self) -> None:
        """What comes next begins anew, with names of its own."""
        self._used, self._cells, self._begins = [], 0, True

    def named(self) -> Samples | None:
        """A sample without values of the signals that are named; None before that."""
        if not self._used:
            return None
        keys = {meaning.key: meaning.unit for _, meaning in self._used if meaning.key != TIME}
        return Samples(
            np.full(1, np.nan), {key: np.full(1, np.nan) for key in keys}, keys, source=self._source
        )

    def read(self, lines: Sequence[str]) -> list[Samples]:
        """The samples of some whole lines; with new names between them, in several parts.

        Raises:
            InputError: names that are not understood, or samples without names before them.
        """
        found: list[Samples] = []
        rows: list[list[float]] = []
        for line in lines:
            text = line.strip("\r\n")
            if not text.strip() or text.startswith("#"):
                continue
            if self._is_header(text):
                found += self._samples(rows)
                rows = []
                self._name(text)
                continue
            if not self._used:
                raise InputError(f"{self._source}: samples without a line before them that names the columns")
            row = self._row(text)
            if row is not None:
                rows.append(row)
        return found + self._samples(rows)

    def _is_header(self, text: str) -> bool:
        """Whether no cell is a number, and one is there."""
        cells = [cell.strip() for cell in text.replace(";", ",").replace("\t", ",").split(",")]
        return any(cells) and not any(_is_number(cell) for cell in cells)

    def _name(self, text: str) -> None:
        self._separator = max(_SEPARATORS, key=text.count)
        names = [
            name.strip().lstrip("\ufeff") for name in next(csv.reader([text], delimiter=self._separator))
        ]
        used: list[tuple[int, ColumnName]] = []
        for place, name in enumerate(names):
            target = self._mapping.get(name, name)
            if target == IGNORE:
                continue
            try:
                meaning = parse_column(target)
            except InputError as error:
                raise InputError(f"{self._source}: {error}") from None
            if meaning is None:
                continue
            if any(meaning.key == known.key for _, known in used):
                raise InputError(f"{self._source}: two columns hold {meaning.key}")
            used.append((place, meaning))
        if not any(meaning.key == TIME for _, meaning in used) or len(used) < 2:
            shown = ", ".join(repr(name[:40]) for name in names[:8])
            raise InputError(
                f"{self._source}: the first line must name time_s (or time_ms ...) and signals, <joint>.<quantity>_"
                f"<unit>, as in a recording; it has {shown}"
            )
        self._used, self._cells = used, len(names)

    def _row(self, text: str) -> list[float] | None:
        """Values in SI of the columns that are used; None for a line that is no sample."""
        cells = text.split(self._separator)
        why = ""
        if len(cells) != self._cells:
            why = f"{len(cells)} cells; {self._cells} columns were named"
        else:
            try:
                row = [self._value(cells[place]) * meaning.factor for place, meaning in self._used]
                self.bad_in_a_row = 0
                return row
            except ValueError:
                why = "a cell is no number"
        self.bad, self.bad_in_a_row = self.bad + 1, self.bad_in_a_row + 1
        self.last_bad = f"{text[:40]!r}: {why}"
        return None

    def _value(self, cell: str) -> float:
        text = cell.strip()
        if not text:
            return float("nan")
        if "_" in text:  # Python reads 1_000 as a number; no measuring program writes that
            raise ValueError
        return float(text.replace(",", ".", 1) if self._separator != "," else text)

    def _samples(self, rows: list[list[float]]) -> list[Samples]:
        if not rows:
            return []
        values = np.array(rows)
        by_key = {meaning.key: values[:, i] for i, (_, meaning) in enumerate(self._used)}
        time = by_key.pop(TIME)
        units = {meaning.key: meaning.unit for _, meaning in self._used if meaning.key != TIME}
        begins, self._begins = self._begins, False
        return [Samples(time, by_key, units, begins, self._source)]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
