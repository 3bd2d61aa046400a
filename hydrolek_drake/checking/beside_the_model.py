"""What looks wrong with a recording beside one rollout of its rig: sign, size and time of the motion, pressures."""

import numpy as np

from hydrolek_drake.checking.complaint import Complaint
from hydrolek_drake.checking.slips import column, slip_of
from hydrolek_drake.checking.speeds import correlation, speed_of
from hydrolek_drake.checking.steps import differs
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.readings import SUPPLY_KEY, position_key
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import recorded_inputs
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.rest import rest_state_at_reading
from hydrolek_drake.rollout.rollout import Signals

AGAINST = -0.4
"""Correlation of speeds below which a joint moves against what the rig says."""

WITH = 0.4
"""Correlation above which it moves as the rig says, so that sizes and times can be compared."""

SURELY, CLEARLY_BETTER = 0.85, 0.1
"""Correlation of the speeds from which a lag is believed, and by which it is better than none."""

CHANGED = 0.01
"""A command changes by more than this share of its range; less is the noise of one that was measured."""

MOST_S = 1.0
"""Clocks may be apart by so much, either way [s]."""

LAG_S = 0.005
"""Lags between them are tried so far apart at least [s]: half a sample of most recordings."""

FALLEN = 0.85
"""A supply below this share of its relief valve's setting gives all that it can."""


def against_the_model(
    rig: Rig,
    joint: str,
    recording: Recording,
    volts: np.ndarray,
    position: np.ndarray,
    noise: float,
    unit: str,
) -> list[Complaint]:
    """Sign, size and time of the motion beside one rollout."""
    record, times, key = rig.records()[:1], recording.time, position_key(rig, joint)
    first = position[np.isfinite(position)][:5]
    start = float(np.median(first))
    state = rest_state_at_reading(record, start) if _within(rig, joint, start) else None
    step = rig.value("integration.longest_step")
    recorded = recorded_inputs(rig, joint, recording)
    spool_steps = round(rig.value("integration.spool_steps"))
    outcome = roll_out(
        record, times, volts, times, state=state, longest_step=step, spool_steps=spool_steps, probes=recorded
    )
    if outcome.diverged:
        return [Complaint(key, f"the model {outcome.diverged} under this command", "", wrong=False)]
    model = outcome.signals
    seen, own = speed_of(times, position), speed_of(times, model.reading)
    together = correlation(seen, own)
    shifted = _late(rig, joint, times, seen, np.where(_about_changes(times, volts)[: own.size], own, np.nan))
    if together < AGAINST and not shifted:
        polarity = rig.value(f"joints.{joint}.command.polarity")
        return [
            Complaint(
                f"{joint}.command",
                f"the joint moves against its command (correlation of the speeds {together:.2f}): a sign is wrong",
                f'command: {{polarity: {{value: {-polarity:g}, unit: "1", ...}}}}',
            )
        ]
    found = shifted
    if together > WITH:
        good = np.isfinite(seen) & np.isfinite(own)
        ratio = float(np.sqrt(np.mean(seen[good] ** 2) / np.mean(own[good] ** 2)))
        if slip := slip_of(ratio, unit):
            return [
                Complaint(
                    key,
                    f"moves {ratio:.3g} times as fast as the model: {slip[0]}?",
                    column(key, "deg" if slip[1] == "rad" else "mm" if slip[1] == "m" else unit, slip[1]),
                )
            ]
    found += _exchanged(rig, joint, recording, model)
    found += _falls(rig, recording, model)
    off = differs(rig.by_itself(), joint, times, volts, step, noise)
    if off is not None and off > 1.0:
        found.append(
            Complaint(
                "integration.longest_step",
                f"{1e3 * step:g} ms is too long: finer steps change the motion by {off:.2g} times what is allowed",
                "",
            )
        )
    return found


def _within(rig: Rig, joint: str, position: float) -> bool:
    lower, upper = (rig.value(f"joints.{joint}.load.{name}") for name in ("lower_stop", "upper_stop"))
    return lower <= position <= upper


def _about_changes(times: np.ndarray, volts: np.ndarray) -> np.ndarray:
    """Samples before and after which the command changes: when a joint begins to move says when its command came.

    When it comes to a stop under a constant command says how fast it is. # (n,) truth values
    """
    changed = times[1:][np.abs(np.diff(volts)) > CHANGED * np.ptp(volts)]
    if not changed.size:
        return np.ones(times.size, dtype=bool)
    after = np.searchsorted(changed, times)
    last, next_ = changed[np.maximum(after - 1, 0)], changed[np.minimum(after, changed.size - 1)]
    return np.minimum(np.abs(times - last), np.abs(times - next_)) <= MOST_S


def _late(rig: Rig, joint: str, times: np.ndarray, seen: np.ndarray, own: np.ndarray) -> list[Complaint]:
    """Whether the joint answers earlier than any machine could."""
    spacing = float(np.median(np.diff(times)))
    every = max(round(LAG_S / spacing), 1)
    seen, own, spacing = seen[::every], own[::every], every * spacing
    most = min(round(MOST_S / spacing), seen.size // 3)
    lags = list(range(-most, most + 1))
    corr = [correlation(seen[most + k : seen.size - most + k], own[most : own.size - most]) for k in lags]
    lag = lags[int(np.argmax(corr))] * spacing
    if max(corr) < SURELY or max(corr) < corr[most] + CLEARLY_BETTER:
        return []
    delay = rig.value(f"joints.{joint}.command.delay")
    if lag < -(delay + 2.0 * spacing):
        return [
            Complaint(
                "time",
                f"the joint moves {-lag - delay:.3g} s before its command: the clocks of command and sensor are apart",
                "",
            )
        ]
    if lag > delay + 5.0 * spacing:
        return [
            Complaint(
                "time",
                f"the joint moves {lag:.3g} s later than the rig's dead time of {delay:.3g} s has it: more dead "
                "time, or clocks that are apart",
                f"command: {{delay: {{value: {1e3 * (delay + lag):.3g}, unit: ms, ...}}}}",
                wrong=False,
            )
        ]
    return []


def _exchanged(rig: Rig, joint: str, recording: Recording, model: Signals) -> list[Complaint]:
    keys = [f"{joint}.pressure_a", f"{joint}.pressure_b"]
    if any(key not in recording.signals or key in rig.driven_by for key in keys):
        return []
    a, b = (np.asarray(recording.signal(key), dtype=float) for key in keys)
    own_a, own_b = (np.asarray(getattr(model, name)) for name in ("pressure_a", "pressure_b"))
    straight = correlation(a, own_a) + correlation(b, own_b)
    crossed = correlation(a, own_b) + correlation(b, own_a)
    if crossed < straight + 2.0 * WITH or crossed < 2.0 * WITH:
        return []
    return [
        Complaint(
            keys[0],
            f"pressures of side A and side B are exchanged: each follows the other one's model (correlations "
            f"{0.5 * crossed:.2f} for {0.5 * straight:.2f})",
            f"recording: {{columns: {{{keys[0]}_Pa: {keys[1]}_Pa, {keys[1]}_Pa: {keys[0]}_Pa}}}}",
        )
    ]


def _falls(rig: Rig, recording: Recording, model: Signals) -> list[Complaint]:
    """Whether the supply falls where the rig's pump would hold it."""
    if rig.variants["supply"] != "pump" or SUPPLY_KEY not in recording.signals or SUPPLY_KEY in rig.driven_by:
        return []
    setting = rig.value("supply.pressure")
    lowest = float(np.nanmin(recording.signal(SUPPLY_KEY)))
    own = float(np.min(model.supply_pressure))
    highest = float(np.nanmax(recording.signal(SUPPLY_KEY)))
    if not (lowest < FALLEN * setting < highest and own > 0.5 * (1.0 + FALLEN) * setting):
        return []
    per_turn = 1e6 * rig.value("supply.displacement")
    return [
        Complaint(
            "supply.displacement",
            f"the supply falls to {1e-6 * lowest:.3g} MPa in the recording, with the rig's pump to {1e-6 * own:.3g} "
            "MPa: it gives less than the rig says; was its displacement meant per turn?",
            f"displacement: {{value: {per_turn:.4g}, unit: cm^3/rev, ...}}",
        )
    ]
