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

    def __str__(self) -> str:
        """The summary."""
        return self.summary()

    def _repr_html_(self) -> str:
        """What a notebook shows: the summary, and the table where pandas is installed."""
        lines = "".join(f"<p>{html.escape(line)}</p>" for line in self.summary().splitlines())
        try:
            table = self.to_pandas()
        except InputError:
            return lines
        return lines + str(table.to_html(max_rows=30, border=0, float_format=lambda v: f"{v:.5g}"))


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
