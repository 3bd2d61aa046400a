"""Result of a watch."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hydrolek_drake.api.results import Result, pandas_module
from hydrolek_drake.watching.alarms import Alarm, is_effect
from hydrolek_drake.watching.figures import left_figure, size_figure
from hydrolek_drake.watching.limits import Limit
from hydrolek_drake.watching.results import write_watch
from hydrolek_drake.watching.table import table_of
from hydrolek_drake.watching.watch import Watched
from hydrolek_drake.watching.words import sentences

if TYPE_CHECKING:
    import pandas


IN_SHORT = ("joint", "size", "low", "high", "unit", "gain", "evidence", "beside_size", "beside_gain")
"""Columns of the table that a notebook shows."""


@dataclass(frozen=True, repr=False)
class WatchResult(Result):
    """What changed on a machine since its reference.

    Attributes:
        watched: recordings with what they say.
        limits: sizes that effects must not reach.
    """

    watched: Watched
    limits: Sequence[Limit] = ()

    @property
    def alarm(self) -> Alarm | None:
        """What is wrong and since when; None for nothing."""
        return self.watched.alarm

    def summary(self) -> str:
        """The outcome, growth and forecasts, and what could not be asked."""
        return "\n".join(sentences(self.watched, self.limits))

    def to_pandas(self) -> "pandas.DataFrame":
        """One row a recording and effect; columns as in `watch.parquet` (`watching.table.COLUMNS`)."""
        return pandas_module().DataFrame(
            table_of([*self.watched.reference, *self.watched.seen], self.watched.evidence)
        )

    def in_short(self) -> "pandas.DataFrame":
        """The effects of the last recording, what gains most first."""
        table = self.to_pandas()
        if not self.watched.asked:
            return table[["recording", "problem"]].dropna()
        last = table[table["sha256"] == self.watched.asked[-1].digest].sort_values("gain", ascending=False)
        return last.set_index("effect")[list(IN_SHORT)]

    def plot(self, effect: str | None = None) -> Any:
        """An effect's size over time with trend and limits, as a Plotly figure.

        Args:
            effect: its id; None for that of the alarm or the first limit, or, without either, what models leave.
        """
        limited = next((limit.effect for limit in self.limits), None)
        alarmed = self.alarm.effect if self.alarm is not None and is_effect(self.alarm.effect) else None
        name = effect or alarmed or limited
        joints = [e.joint for a in self.watched.answers[-1:] for e in a.effects if e.effect == name]
        if name is None or not joints:
            return left_figure(self.watched)
        joint = self.alarm.joint if self.alarm is not None and name == self.alarm.effect else joints[0]
        return size_figure(self.watched, name, joint, self.limits)

    def write(self, folder: str | Path) -> list[Path]:
        """Write `watch.parquet` and `watch.html` into a folder, and return their paths.

        Raises:
            InputError: it cannot be written to.
        """
        return write_watch(self.watched, Path(folder), self.limits)
