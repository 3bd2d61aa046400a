"""What every result can do: a summary, a table, a picture, and itself in a notebook."""

import html
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    import pandas


class Result(ABC):
    """The outcome of one of the functions of `hydrolek_drake.api`."""

    @abstractmethod
    def summary(self) -> str:
        """What came out, in sentences, one a line."""

    @abstractmethod
    def to_pandas(self) -> "pandas.DataFrame":
        """The numbers as a table in SI units.

        Raises:
            InputError: pandas is not installed.
        """

    @abstractmethod
    def plot(self) -> Any:
        """A picture, as a Plotly figure."""

    def in_short(self) -> "pandas.DataFrame":
        """What of the table a notebook shows; all of it here."""
        return self.to_pandas()

    def __str__(self) -> str:
        """The summary."""
        return self.summary()

    def _repr_html_(self) -> str:
        """What a notebook shows: the summary, and the table in short where pandas is installed."""
        lines = "".join(f"<p>{html.escape(line)}</p>" for line in self.summary().splitlines())
        try:
            table = self.in_short()
        except InputError:
            return lines
        told = table.to_html(max_rows=30, border=0, na_rep="", float_format=lambda v: f"{v:.5g}")
        return f"{lines}<div style='overflow-x:auto'>{told}</div>"


def pandas_module() -> Any:
    """The package pandas.

    Raises:
        InputError: it is not installed.
    """
    try:
        import pandas
    except ImportError:
        raise InputError("pandas is not installed; pip install 'hydrolek-drake[notebook]'") from None
    return pandas
