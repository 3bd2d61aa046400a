"""One recording of one joint, prepared so that a rollout can be held against it again and again."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.identification.experiments.channel import Channel, faithful
from hydrolek_drake.identification.experiments.held_command import without_windows
from hydrolek_drake.identification.experiments.neighbours import rows_at, with_recorded
from hydrolek_drake.identification.experiments.start import without_offset
from hydrolek_drake.identification.experiments.thinning import Blocks, block_size
from hydrolek_drake.physics.driven import FOLLOWED
from hydrolek_drake.physics.probes import PROBES, SUPPLY
from hydrolek_drake.physics.records import copied
from hydrolek_drake.rollout.kernel import PULLED
from hydrolek_drake.rollout.rest import rest_state_at_reading, state_at_reading
from hydrolek_drake.rollout.rollout import Outcome, Signals
from hydrolek_drake.rollout.run import Run


@dataclass(frozen=True)
class Experiment:
    """A joint's command and what was measured under it.

    Attributes:
        name: of the recording.
        joint: the joint's name.
        index: its place among the rig's joints.
        time: of the samples [s]. # (n,)
        command_times: of the command [s]. # (m,)
        command: held from then on [V]. # (m,)
        channels: measured signals, position first.
        start: where the joint rests at the beginning [rad or m]; None for where the rig says.
        start_error: standard deviation of it [rad or m]. An error there stays, since nothing pulls a joint back that
            valves move, but for its stops.
        start_response: by how much each channel changes with the start; None for the position as much, others not at
            all. # (channels, n)
        longest_step: of the rollout [s].
        spool_steps: of the rollout.
        used: samples that count in a fit. # (n,)
        block: so many samples of the recording were averaged to one; 1 for none.
        others: what joints that move at the same time do to this one, as probes of the rollout; None if it moves
            alone.
        others_error: by how much each channel of a rollout is wrong since `others` is not quite what they do; None if
            that is not known. # (channels, n)
        recorded: what is recorded in place of a part of the model, as probes of the rollout; None for nothing.
        cut: part of the model that `recorded` replaces for what lies behind it, besides those that the rig names, while
            the part itself is followed under what is drawn of it (`physics.driven.FOLLOWED`).
        state: where a joint that does not rest at the beginning is, as an observer left it, see `kernel.integrate`; it
            is moved to where the sensor reads `start`. None for one that rests. # (18,)
    """

    name: str
    joint: str
    index: int
    time: np.ndarray
    command_times: np.ndarray
    command: np.ndarray
    channels: tuple[Channel, ...]
    start: float | None
    longest_step: float
    spool_steps: int
    used: np.ndarray
    block: int = 1
    others: tuple[float, np.ndarray] | None = None
    others_error: np.ndarray | None = None
    start_error: float = 0.0
    start_response: np.ndarray | None = None
    recorded: tuple[float, np.ndarray] | None = None
    cut: str | None = None
    state: np.ndarray | None = None

    @property
    def command_at_samples(self) -> np.ndarray:
        """The command in force at each sample [V]. # (n,)."""
        held = np.searchsorted(self.command_times, self.time, side="right") - 1
        return self.command[np.maximum(held, 0)]

    def simulate(
        self,
        records: np.ndarray,
        longest_step: float | None = None,
        probes: tuple[float, np.ndarray] | None = None,
        pull_time: float | None = None,
        law: np.ndarray | None = None,
    ) -> Outcome:
        """Roll the joint out under the recorded command.

        Args:
            records: of all joints of the rig. # (joints,)
            longest_step: [s]; None for the rig's own.
            probes: unknown inputs, as in `rollout.roll_out`.
            pull_time: with which reading and pressures are pulled to what was measured [s]; None for a free
                rollout.
            law: for an unknown input, as in `rollout.roll_out`.
        """
        return self.run(records, longest_step, probes, pull_time, law).outcome()

    def run(
        self,
        records: np.ndarray,
        longest_step: float | None = None,
        probes: tuple[float, np.ndarray] | None = None,
        pull_time: float | None = None,
        law: np.ndarray | None = None,
    ) -> Run:
        """The rollout that `simulate` makes, to be made beside others (`rollout.lanes`); arguments as there."""
        record = records[self.index : self.index + 1]
        if self.cut is not None:
            record = copied(record)
            record["driven"][self.cut] = FOLLOWED
        return Run(
            record,
            self.command_times,
            self.command,
            self.time,
            longest_step or self.longest_step,
            self.spool_steps,
            state=self._begin(record),
            probes=with_recorded(self._with_others(probes), self.recorded),
            pull=None if pull_time is None else (pull_time, self._to_follow()),
            law=law,
        )

    def _begin(self, record: np.ndarray) -> np.ndarray | None:
        """State at the beginning; None for where the rig rests. # (18,)."""
        if self.start is None:
            return self.state
        if self.state is None:
            return rest_state_at_reading(record, self.start)
        return state_at_reading(record, self.state, self.start)

    def _with_others(self, probes: tuple[float, np.ndarray] | None) -> tuple[float, np.ndarray] | None:
        """Probes with what the other joints do added."""
        if self.others is None or probes is None:
            return probes or self.others
        spacing, rows = probes
        return spacing, rows + rows_at(self.others, spacing, len(rows))

    def _to_follow(self) -> np.ndarray:
        """What was measured of `PULLED`, a pressure that its noise does not tell from zero as zero. # (n, 3).

        NaN where nothing was.
        """
        nothing = np.full(self.time.size, np.nan)
        by_model = {channel.model: channel.measured_beyond_noise for channel in self.channels}
        return np.stack([by_model.get(name, nothing) for name in PULLED], axis=1)

    def residuals(self, signals: Signals) -> np.ndarray:
        """(measured - model) / noise of every channel, channel after channel; 0 where it does not count.

        What an uncertain start explains is taken out: with the residuals' response a to one standard deviation of it
        their covariance is I + a a', and they are multiplied by its inverse root.

        After a divergence the model has no value: its residual there is NaN. # (channels * n,)
        """
        parts, offsets = [], []
        for number, channel in enumerate(self.channels):
            deviation = channel.deviation
            residual = (channel.measured - getattr(signals, channel.model)) / deviation
            counts = self.used & np.isfinite(channel.measured)
            parts.append(np.where(counts, residual, 0.0))
            response = (
                channel.model == "reading" if self.start_response is None else self.start_response[number]
            )
            offsets.append(self.start_error * counts * response / deviation)
        return without_offset(np.concatenate(parts), np.concatenate(offsets))

    def without_command(self, windows: np.ndarray, neutral: float) -> "Experiment":
        """The same experiment with commands that did not arrive.

        Args:
            windows: begin and end of each [s]; one without length changes nothing. # (k, 2)
            neutral: command that acts meanwhile [V].
        """
        times, command = without_windows(self.command_times, self.command, windows, neutral)
        return replace(self, command_times=times, command=command)

    def cut_at_supply(self) -> "Experiment":
        """The same, cut in two where the supply pressure is measured; itself where it is not, or is cut already.

        The recorded pressure drives what lies behind it, which then does not depend on the supply's numbers, and the
        supply is followed under the flow that is drawn, which then does not depend on its pressure.
        """
        measured = next((c.measured for c in self.channels if c.model == "supply_pressure"), None)
        if measured is None or self.cut is not None:
            return self
        known = np.isfinite(measured)
        rows = np.zeros((max(self.time.size, 2), len(PROBES)))
        at = np.linspace(self.time[0], self.time[-1], len(rows))
        rows[:, SUPPLY] = np.interp(at, self.time[known], measured[known])
        recorded = with_recorded(self.recorded, (float(at[1] - at[0]), rows))
        return replace(self, recorded=recorded, cut="supply_pressure")

    def behind_cut(self) -> "Experiment":
        """What lies behind the cut alone, the supply not followed."""
        return self._with_channels(self.cut is None or c.model != "supply_pressure" for c in self.channels)

    def before_cut(self) -> "Experiment":
        """The supply alone, under the flow that is drawn of it."""
        return self._with_channels(self.cut is None or c.model == "supply_pressure" for c in self.channels)

    def uncut(self) -> "Experiment":
        """The whole chain again, with the supply's own pressure."""
        if self.cut is None or self.recorded is None:
            return self
        spacing, rows = self.recorded
        others = rows * (np.arange(len(PROBES)) != SUPPLY)
        return replace(self, recorded=(spacing, others) if others.any() else None, cut=None)

    def _with_channels(self, chosen: Iterable[bool]) -> "Experiment":
        """The same with some of its channels."""
        which = np.fromiter(chosen, dtype=bool)
        return replace(
            self,
            channels=tuple(c for c, is_one in zip(self.channels, which, strict=True) if is_one),
            start_response=None if self.start_response is None else self.start_response[which],
            others_error=None if self.others_error is None else self.others_error[which],
        )

    def with_every_other_of_recorded(self) -> "Experiment":
        """The same with half of the samples of what is recorded in place of a part of the model.

        Between samples a recorded signal is not known. What the rollout changes by with half of them tells how much
        that matters, as twice the step tells the error of an integration.
        """
        if self.recorded is None:
            return self
        spacing, rows = self.recorded
        even = rows if len(rows) % 2 else np.concatenate([rows, rows[-1:]])
        return replace(self, recorded=(2.0 * spacing, even[::2]))

    def until(self, seconds: float) -> "Experiment":
        """The beginning of the experiment, up to so many seconds after its first sample."""
        count = int(np.searchsorted(self.time, self.time[0] + seconds, side="right"))
        channels = tuple(channel.until(count) for channel in self.channels)
        return replace(
            self,
            time=self.time[:count],
            channels=channels,
            used=self.used[:count],
            start_response=None if self.start_response is None else self.start_response[:, :count],
            others_error=None if self.others_error is None else self.others_error[:, :count],
        )

    def responding(
        self, records: np.ndarray, longest_step: float, signals: Signals, pull_time: float | None = None
    ) -> np.ndarray | None:
        """How a model's channels respond to the start, by a rollout that begins one standard deviation off.

        Args:
            records: of all joints of the rig. # (joints,)
            longest_step: [s].
            signals: of the same model, from the start as it is.
            pull_time: time constant of the observer that gave these [s]; None for a free rollout.

        Returns:
            None where the start is known. # (channels, n)
        """
        if self.start is None or self.start_error == 0.0:
            return None
        begun = replace(self, start=self.start + self.start_error)
        off = begun.simulate(records, longest_step, pull_time=pull_time).signals
        changes = [getattr(off, c.model) - getattr(signals, c.model) for c in self.channels]
        return np.nan_to_num(np.array(changes) / self.start_error)

    @property
    def counted(self) -> int:
        """How many measured values count."""
        return sum(map(self.counted_of, self.channels))

    @property
    def unsure(self) -> float:
        """Squared residuals, in units of the noise, that a model's own error and what other joints do may leave.

        These are errors over the whole recording and not of each sample, so a wrong model may take all of them.
        """
        left = self.admitted
        if self.others is not None:
            left += sum(np.sum(c.model_share[self._counts(c)]) for c in self.channels)
        return float(left)

    @property
    def admitted(self) -> float:
        """Squared residuals that the rig says its equations leave at best, in units of the noise."""
        return float(sum(np.sum(c.least_left[self._counts(c)]) for c in self.channels))

    def counted_of(self, channel: Channel) -> int:
        """How many measured values of one of its channels count."""
        return int(self._counts(channel).sum())

    def _counts(self, channel: Channel) -> np.ndarray:
        """Samples of a channel that count. # (n,)."""
        return self.used & np.isfinite(channel.measured)

    def split(self, used: np.ndarray) -> "Experiment":
        """The same experiment with other samples that count, a truth value each."""
        return replace(self, used=used)

    def thinned(self) -> "Experiment":
        """Averaged over blocks if it is sampled far faster than the model needs, see `thinning`; else itself."""
        size = block_size(self.time, self.longest_step)
        if size == 1:
            return self
        blocks = Blocks(self.time, size)
        channels = tuple(c.averaged(blocks, faithful(c.measured)) for c in self.channels)
        used = np.ones(blocks.time.size, dtype=bool)
        used[0] = False  # a single sample, with which the rollout begins
        return replace(self, time=blocks.time, channels=channels, used=used, block=size)
