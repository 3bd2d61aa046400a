"""One plant, two executions: what rollouts found is run through the Drake Diagram under the recorded commands."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.by_diagram import moved_by_diagram
from hydrolek_drake.replay.comparison import compare, times_of
from hydrolek_drake.replay.display import shown
from hydrolek_drake.replay.driving import Moved
from hydrolek_drake.replay.readings import position_key
from hydrolek_drake.replay.replay import replay
from hydrolek_drake.rigs import Rig


@dataclass(frozen=True)
class Confirmation:
    """A joint's position on the Diagram, beside the rollout and the recording; SI units (rad or m).

    Attributes:
        recording: its name.
        key: `<joint>.<quantity>`.
        unit: SI unit.
        apart_rms: root mean square of Diagram less rollout; None where one of them has no value.
        apart_largest: largest of it.
        rollout_rms: what the rollout leaves of the recording.
        diagram_rms: what the Diagram leaves of it.
        noise: of the recorded signal.
        diverged: why there is no value, or None.
    """

    recording: str
    key: str
    unit: str
    apart_rms: float | None
    apart_largest: float | None
    rollout_rms: float
    diagram_rms: float | None
    noise: float
    diverged: str | None

    def sentence(self) -> str:
        """What an engineer would say."""
        if self.apart_rms is None or self.apart_largest is None or self.diagram_rms is None:
            return f"Drake diagram, {self.recording}, {self.key}: {self.diverged}."
        over = f", {times_of(self.diagram_rms / self.noise)} the noise" if self.noise > 0.0 else ""
        return (
            f"Drake diagram, {self.recording}, {self.key}: within {shown(self.apart_largest, self.unit)} of the "
            f"rollout ({shown(self.apart_rms, self.unit)} rms); it leaves {shown(self.diagram_rms, self.unit)} rms of "
            f"the recording{over} (rollout {shown(self.rollout_rms, self.unit)})."
        )

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)


def confirm(
    rig: Rig,
    recordings: Sequence[Recording],
    say: Callable[[str], None] | None = None,
    more: Callable[[str], None] | None = None,
) -> list[Confirmation]:
    """Run a rig through its Diagram under each recording's commands, and hold it beside rollout and recording.

    Args:
        rig: with the values that were found.
        recordings: what it is driven with.
        say: told what is done.
        more: told how much of a recording is simulated, and how long the rest may take at the pace so far.
    """
    found = []
    for recording in recordings:
        if say is not None:
            say(f"running {recording.name} through the Drake diagram")
        by_rollout, by_diagram = replay(rig, recording), replay(rig, recording, by=_by_diagram(more))
        left, right = ({c.key: c for c in compare(done)} for done in (by_rollout, by_diagram))
        for joint, one in by_rollout.outcomes.items():
            other, key = by_diagram.outcomes[joint], position_key(rig, joint)
            apart = other.signals.reading - one.signals.reading
            diverged = one.diverged or other.diverged
            known = diverged is None
            found.append(
                Confirmation(
                    recording.name,
                    key,
                    left[key].unit,
                    float(np.sqrt(np.mean(apart**2))) if known else None,
                    float(np.abs(apart).max()) if known else None,
                    left[key].rms,
                    right[key].rms if known else None,
                    left[key].noise,
                    diverged,
                )
            )
    return found


def _by_diagram(more: Callable[[str], None] | None) -> Callable[..., dict[str, Moved]]:
    """The Diagram that tells how far it is."""
    if more is None:
        return moved_by_diagram
    begun = time.monotonic()

    def told(now: float, end: float) -> None:
        left = (time.monotonic() - begun) / now * (end - now)
        more(f"{now:.1f} of {end:.1f} s simulated, about {math.ceil(left)} s more")

    return partial(moved_by_diagram, on_progress=told)
