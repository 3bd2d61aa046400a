"""Results of a replay, a fit and a diagnosis."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hydrolek_drake.api.results import Result, pandas_module
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.comparison import Comparison, compare
from hydrolek_drake.replay.panels import panels
from hydrolek_drake.replay.plots_html import plots_figure
from hydrolek_drake.replay.replay import Replay
from hydrolek_drake.replay.replay import replay as run_replay
from hydrolek_drake.rigs import Rig

if TYPE_CHECKING:
    import pandas

    from hydrolek_drake.diagnosis.diagnosis import Diagnosis
    from hydrolek_drake.identification.fit import RigFit


@dataclass(frozen=True, repr=False)
class ReplayResult(Result):
    """A model under a recorded command, beside what was measured.

    Attributes:
        replay: commands, outcomes and pairs of signals.
        comparisons: error of each signal, where and when.
    """

    replay: Replay
    comparisons: tuple[Comparison, ...]

    def summary(self) -> str:
        """One sentence a signal, and notes."""
        return "\n".join([*(each.sentence() for each in self.comparisons), *self.replay.notes])

    def to_pandas(self) -> "pandas.DataFrame":
        """One row a signal: errors in its SI unit."""
        rows = [
            {
                "signal": each.key,
                "unit": each.unit,
                "rms": each.rms,
                "noise": each.noise,
                "rms_over_noise": each.rms_over_noise,
                "mean": each.mean,
                "largest": each.largest,
                "largest_at_s": each.largest_at,
            }
            for each in self.comparisons
        ]
        return pandas_module().DataFrame(rows).set_index("signal")

    def plot(self) -> Any:
        """Measured, model and residual of each signal over time, as a Plotly figure."""
        return plots_figure([panels(self.replay, self.comparisons)])


@dataclass(frozen=True, repr=False)
class FitResult(Result):
    """A fitted rig.

    Attributes:
        fitted: values, intervals, how well they follow.
        recordings: that were fitted.
    """

    fitted: "RigFit"
    recordings: tuple[Recording, ...]

    @property
    def rig(self) -> Rig:
        """With the fitted values; every other function takes it."""
        return self.fitted.rig

    def summary(self) -> str:
        """How well the model follows, and what the recordings cannot tell."""
        from hydrolek_drake.identification.fit.report import sentences

        return "\n".join(sentences(self.fitted))

    def to_pandas(self) -> "pandas.DataFrame":
        """One row a parameter: value, 95 % interval (SI), unit."""
        rows = [
            {"parameter": path, "value": value, "low": low, "high": high, "unit": self.rig.entries[path].unit}
            for path, (value, low, high) in self.fitted.intervals().items()
        ]
        return pandas_module().DataFrame(rows).set_index("parameter")

    def plot(self) -> Any:
        """The fitted model beside the first recording, as a Plotly figure."""
        done = run_replay(self.rig, self.recordings[0])
        return plots_figure([panels(done, compare(done))])

    def write(self, folder: str | Path) -> list[Path]:
        """Write `rig_fitted.yaml` and `fit.json` into a folder, and return their paths.

        Raises:
            InputError: it cannot be written to.
        """
        from hydrolek_drake.identification.fit.report import write_fit

        return write_fit(self.fitted, Path(folder))


@dataclass(frozen=True, repr=False)
class DiagnosisResult(Result):
    """What physics a rig's model leaves out.

    Attributes:
        diagnosis: verdict, structures, intervals, places.
        effects: as in `report.json`, the most probable first: id, probability, parameters, sentence.
    """

    diagnosis: "Diagnosis"
    effects: list[dict[str, Any]] = field(default_factory=list)

    @property
    def verdict(self) -> str:
        """As in `report.json`."""
        return self.diagnosis.verdict

    @property
    def rig(self) -> Rig:
        """With the named effects on and every parameter estimated anew; the rig as given for bad data."""
        return self.diagnosis.rig if self.diagnosis.bench is None else self.diagnosis.fitted_rig()

    def summary(self) -> str:
        """The verdict in a sentence, one sentence an effect, and remarks."""
        from hydrolek_drake.diagnosis.report.words import headline

        told = [each["sentence"] for each in self.effects]
        return "\n".join([headline(self.diagnosis), *told, *self.diagnosis.reasons])

    def to_pandas(self) -> "pandas.DataFrame":
        """One row a parameter of the best model: value, 95 % interval (SI), unit."""
        rows = [
            {
                "parameter": path,
                "value": known.value,
                "low": known.low,
                "high": known.high,
                "unit": self.diagnosis.rig.entries[path].unit,
            }
            for path, known in self.diagnosis.intervals.items()
        ]
        columns = ["parameter", "value", "low", "high", "unit"]
        return pandas_module().DataFrame(rows, columns=columns).set_index("parameter")

    def plot(self) -> Any:
        """Measured, before and after, as a Plotly figure; an empty one for bad data."""
        from hydrolek_drake.diagnosis.report.panels import columns

        if self.diagnosis.bench is None:
            from plotly.graph_objects import Figure

            return Figure()
        return plots_figure(columns(self.diagnosis))

    def write(self, folder: str | Path) -> Path:
        """Write what `hydrolek diagnose --out` writes, and return the page's path.

        Raises:
            InputError: it cannot be written to.
        """
        from hydrolek_drake.diagnosis.report.files import write_report

        return write_report(self.diagnosis, Path(folder))
