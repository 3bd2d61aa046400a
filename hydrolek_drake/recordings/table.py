"""What a reader hands over: the columns of a file as they stand there, not yet understood."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.recordings.finding import Finding


@dataclass(frozen=True)
class Column:
    """One column of a file.

    Attributes:
        names: Names that the column answers to, the fullest first: `("arm.angle_deg", "angle_deg")`.
        values: Numbers, or text cells that may or may not be numbers (object or string array). # (n,)
        group: What it was recorded with, by one clock: a topic, a group of channels, a struct; "" where the file has
            one clock for all. `a.b` lies in `a`, whose clock is its own if it has none.
    """

    names: tuple[str, ...]
    values: np.ndarray
    group: str = ""

    @property
    def name(self) -> str:
        """The name to use in messages."""
        return self.names[0]


@dataclass(frozen=True)
class Table:
    """All columns of a file.

    Attributes:
        columns: In the order of the file; lengths may differ.
        row_name: What the file calls a row: "line" for text files, else "row".
        rows: Number of each row in the file, or None if they simply count from 1. # (n,)
        decimal_comma: Text cells may use a comma as the decimal mark.
        findings: What the reader itself noticed.
        cut_off: The file ends before it is finished, as when its recorder was killed.
        hint: What would let more of the file be read, for the message that something is not there.
    """

    columns: tuple[Column, ...]
    row_name: str = "row"
    rows: np.ndarray | None = None
    decimal_comma: bool = False
    findings: tuple[Finding, ...] = ()
    cut_off: bool = False
    hint: str = ""

    def row(self, index: int) -> str:
        """How to call the sample with this index in a message: "line 17"."""
        return f"{self.row_name} {index + 1 if self.rows is None else self.rows[index]}"
