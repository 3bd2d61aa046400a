"""A recording: what was commanded and what was measured, over time, in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.columns import HELD_QUANTITIES, default_unit, quantity_of
from hydrolek_drake.recordings.finding import Finding
from hydrolek_drake.recordings.resampling import held, linear

_ROUNDING = 1e-9  # of the duration: times computed as start + i * step may miss the end by this much


@dataclass(frozen=True, eq=False)
class Recording:
    """Signals over a common, strictly increasing time.

    Attributes:
        name: Short name for messages and reports.
        time: As recorded, so it need not start at zero nor be uniform [s]. # (n,)
        signals: By `<joint>.<quantity>`, for example `right_j2.pressure_a`, in SI units; NaN where the
            recording has no value. # (n,) each
        source: File or folder that it was read from.
        findings: What is noteworthy about it: gaps, NaNs, clock, saturated and constant channels.
        ignored: Columns of the file that hold no known signal.
        units: SI unit of each signal.
    """

    name: str
    time: np.ndarray
    signals: dict[str, np.ndarray]
    source: Path
    findings: tuple[Finding, ...] = ()
    ignored: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        time = _frozen(self.time)
        if time.ndim != 1 or time.size < 2 or not (np.diff(time) > 0).all():
            raise InputError(f"recording {self.name}: time must be two or more strictly increasing numbers")
        signals = {key: _frozen(values) for key, values in self.signals.items()}
        for key, values in signals.items():
            if values.shape != time.shape:
                raise InputError(
                    f"recording {self.name}: signal {key} has shape {values.shape}, time {time.shape}"
                )
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "signals", signals)
        object.__setattr__(
            self, "units", {key: self.units.get(key) or default_unit(key) or "1" for key in signals}
        )

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    def signal(self, key: str) -> np.ndarray:
        """One signal in SI units, one value for each time.

        Raises:
            InputError: The recording has no such signal.
        """
        if key not in self.signals:
            raise InputError(
                f"recording {self.name} ({self.source}) has no signal {key!r}; "
                f"it has {', '.join(sorted(self.signals))}"
            )
        return self.signals[key]

    def between(self, start: float, end: float) -> "Recording":
        """The samples from `start` to `end` [s], both included, with the findings that fall into that time.

        Raises:
            InputError: Fewer than two samples are left.
        """
        keep = (self.time >= start) & (self.time <= end)
        if keep.sum() < 2:
            raise InputError(
                f"recording {self.name} ({self.source}) has {int(keep.sum())} samples between {start:g} s "
                f"and {end:g} s; it lasts from {self.time[0]:.9g} s to {self.time[-1]:.9g} s"
            )
        return replace(
            self,
            time=self.time[keep],
            signals={key: values[keep] for key, values in self.signals.items()},
            findings=tuple(cut for finding in self.findings if (cut := finding.within(start, end))),
        )

    def resampled(self, times: np.ndarray) -> "Recording":
        """The signals at other times: commands and references held, sensors on straight lines.

        Sensors are NaN inside gaps, where nothing was measured.

        Args:
            times: Strictly increasing times within the recording [s]. # (m,)

        Raises:
            InputError: A time lies outside the recording, or the times do not increase.
        """
        times = np.asarray(times, dtype=float)
        slack = _ROUNDING * self.duration
        if times.size and not (times.min() >= self.time[0] - slack and times.max() <= self.time[-1] + slack):
            raise InputError(
                f"recording {self.name} ({self.source}) cannot be resampled from {times.min():.9g} s to "
                f"{times.max():.9g} s; it lasts from {self.time[0]:.9g} s to {self.time[-1]:.9g} s"
            )
        at = np.clip(times, self.time[0], self.time[-1])
        return replace(
            self,
            time=times,
            signals={
                key: (held if quantity_of(key) in HELD_QUANTITIES else linear)(self.time, values, at)
                for key, values in self.signals.items()
            },
        )


def _frozen(values: np.ndarray) -> np.ndarray:
    """A copy that cannot be written to: recordings are shared between fits."""
    copy = np.array(values, dtype=float)
    copy.setflags(write=False)
    return copy
