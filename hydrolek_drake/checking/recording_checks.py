"""What looks wrong with a recording of a machine: signs, units, exchanged columns, clocks; and what it cannot tell."""

import math

import numpy as np

from hydrolek_drake.checking.clock import refuse_other_clock
from hydrolek_drake.checking.complaint import Complaint
from hydrolek_drake.checking.steps import differs
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.noise import noise_level
from hydrolek_drake.replay.readings import SUPPLY_KEY, driven_joints, measured_position, position_key
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.recorded_inputs import recorded_inputs, with_commands
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.rest import rest_state_at_reading
from hydrolek_drake.rollout.rollout import Signals

AGAINST = -0.4
"""Correlation of speeds below which a joint moves against what the rig says."""

WITH = 0.4
"""Correlation above which it moves as the rig says, so that sizes and times can be compared."""

UNITS = {
    "rad": ((180.0 / math.pi, "deg in a column of rad", "deg"), (math.pi / 180.0, "rad in a column of deg", "rad")),
    "m": ((1e3, "mm in a column of m", "mm"), (1e-3, "m in a column of mm", "m")),
    "Pa": (
        (1e-5, "bar in a column of Pa", "bar"), (1e-6, "MPa in a column of Pa", "MPa"),
        (1e-3, "kPa in a column of Pa", "kPa"),
        (1e5, "Pa in a column of bar", "Pa"), (1e6, "Pa in a column of MPa", "Pa"),
        (10.0, "bar in a column of MPa", "bar"),
        (0.1, "MPa in a column of bar", "MPa"), (1e3, "Pa in a column of kPa", "Pa"),
    ),
    "V": ((1e3, "mV in a column of V", "mV"), (1e-3, "V in a column of mV", "V")),
}  # fmt: skip
"""SI unit -> factor by which values are off, the slip that makes it, and the unit that they have."""

NEAR_FACTOR = 2.0
"""A ratio within this factor of a slip's is that slip, where it is further than `ANOTHER` from one."""

ANOTHER = 5.0

SURELY, CLEARLY_BETTER = 0.85, 0.1
"""Correlation of the speeds from which a lag is believed, and by which it is better than none."""

FALLEN = 0.85
"""A supply below this share of its relief valve's setting gives all that it can."""

PLAUSIBLE, LARGEST = (0.03, 5.0), 0.7
"""Shares of the supply pressure between which the largest pressure of a recording lies, and where it mostly does."""

REVERSALS = 4
"""Changes of direction without which friction and play are not told from anything else."""

SHARE_OF_COMMAND = 0.05
"""Of the limit: a command below tells neither speeds nor saturation."""

SHARE_OF_TRAVEL = 0.05
"""Of the way between the stops: a motion below tells no geometry."""


def check_recording(rig: Rig, recording: Recording) -> list[Complaint]:
    """What is implausible about a recording, of each joint that is driven alone in it.

    Raises:
        InputError: as of `refuse_other_clock`.
    """
    refuse_other_clock(rig, recording)
    recording = with_commands(rig, recording)
    found: list[Complaint] = []
    for joint in driven_joints(rig, recording):
        found += _joint(rig, joint, recording)
    found += _pressures(rig, recording)
    return found


def _column(key: str, unit: str, to: str) -> str:
    """The line of the rig that gives a column another unit."""
    return f"recording: {{columns: {{{key}_{unit}: {key}_{to}}}}}"


def _slip(ratio: float, unit: str) -> tuple[str, str] | None:
    """Which slip of unit makes values so many times too large: what it is called, and the unit that they have."""
    if not ratio > 0.0 or 1.0 / ANOTHER < ratio < ANOTHER:
        return None
    for factor, called, has in UNITS[unit]:
        if 1.0 / NEAR_FACTOR < ratio / factor < NEAR_FACTOR:
            return called, has
    return None


def _speed(times: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Speed over a tenth of a second, which noise does not drown."""
    width = max(round(0.1 / float(np.median(np.diff(times)))), 1)
    if position.size <= 2 * width:
        width = 1
    return (position[width:] - position[:-width]) / (times[width:] - times[:-width])


def _correlation(a: np.ndarray, b: np.ndarray) -> float:
    good = np.isfinite(a) & np.isfinite(b)
    if good.sum() < 3 or np.ptp(a[good]) == 0.0 or np.ptp(b[good]) == 0.0:
        return 0.0
    return float(np.corrcoef(a[good], b[good])[0, 1])


def _joint(rig: Rig, joint: str, recording: Recording) -> list[Complaint]:
    key = position_key(rig, joint)
    volts = np.asarray(recording.signal(f"{joint}.command"), dtype=float)
    position = np.asarray(measured_position(rig, joint, recording), dtype=float)
    found = _command(rig, joint, volts) if rig.needs_command(joint) else []
    if not np.isfinite(position).any() or not np.isfinite(volts).all():
        return found
    noise = noise_level(position)
    if np.nanmax(position) - np.nanmin(position) <= 6.0 * max(noise, np.finfo(float).tiny):
        return [*found, Complaint(key, "does not move: it is constant but for its noise", "")]
    unit = "m" if key.endswith("position") else "rad"
    slipped = _beyond_its_stops(rig, joint, key, position, unit)
    if found or slipped or len(rig.joints) > 1:
        return found + slipped
    return [
        *_against_the_model(rig, joint, recording, volts, position, noise, unit),
        *_told(rig, joint, recording, volts, position),
    ]


def _command(rig: Rig, joint: str, volts: np.ndarray) -> list[Complaint]:
    key, limit = f"{joint}.command", rig.value(f"joints.{joint}.command.limit")
    largest = float(np.nanmax(np.abs(volts - rig.value(f"joints.{joint}.command.neutral"))))
    if np.nanmax(volts) == np.nanmin(volts):
        return [Complaint(key, f"is constant at {volts[0]:g} V: nothing can be told", "")]
    if largest > 20.0 * limit:
        return [
            Complaint(
                key,
                f"reaches {largest:.4g} V, the limit is {limit:g} V: mV in a column of V?",
                _column(key, "V", "mV"),
            )
        ]
    if largest < 1e-2 * limit:
        return [
            Complaint(
                key,
                f"reaches {largest:.2g} V, the limit is {limit:g} V: V in a column of mV?",
                _column(key, "mV", "V"),
            )
        ]
    return []


def _beyond_its_stops(rig: Rig, joint: str, key: str, position: np.ndarray, unit: str) -> list[Complaint]:
    lower, upper = (rig.value(f"joints.{joint}.load.{name}") for name in ("lower_stop", "upper_stop"))
    way, moved = upper - lower, float(np.nanmax(position) - np.nanmin(position))
    if not math.isfinite(way) or moved <= 2.0 * way:
        return []
    slip = next(
        (
            (called, has)
            for factor, called, has in UNITS[unit]
            if factor > 1.0 and moved <= 2.0 * way * factor
        ),
        None,
    )
    called = f": {slip[0]}?" if slip else ""
    return [
        Complaint(
            key,
            f"moves over {moved:.4g} {unit}, its stops are {way:.4g} {unit} apart{called}",
            _column(key, unit, slip[1]) if slip else "",
        )
    ]


def _against_the_model(
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
    outcome = roll_out(record, times, volts, times, state=state, longest_step=step, probes=recorded)
    if outcome.diverged:
        return [Complaint(key, f"the model {outcome.diverged} under this command", "", wrong=False)]
    model = outcome.signals
    seen, own = _speed(times, position), _speed(times, model.reading)
    together = _correlation(seen, own)
    shifted = _late(rig, joint, times, seen, own)
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
        if slip := _slip(ratio, unit):
            return [
                Complaint(
                    key,
                    f"moves {ratio:.3g} times as fast as the model: {slip[0]}?",
                    _column(key, "deg" if slip[1] == "rad" else "mm" if slip[1] == "m" else unit, slip[1]),
                )
            ]
    found += _exchanged(rig, joint, recording, model)
    found += _falls(rig, recording, model)
    off = differs(rig.by_itself(), joint, times, volts, step, noise)
    if off is not None and off > 1.0:
        found.append(
            Complaint(
                "integration.longest_step",
                f"{1e3 * step:g} ms is too long: finer steps differ by {off:.2g} times what may be",
                "",
            )
        )
    return found


def _within(rig: Rig, joint: str, position: float) -> bool:
    lower, upper = (rig.value(f"joints.{joint}.load.{name}") for name in ("lower_stop", "upper_stop"))
    return lower <= position <= upper


def _late(rig: Rig, joint: str, times: np.ndarray, seen: np.ndarray, own: np.ndarray) -> list[Complaint]:
    """Whether the joint answers earlier than any machine could."""
    spacing = float(np.median(np.diff(times)))
    most = min(round(1.0 / spacing), seen.size // 3)
    lags = list(range(-most, most + 1))
    corr = [_correlation(seen[most + k : seen.size - most + k], own[most : own.size - most]) for k in lags]
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
    straight = _correlation(a, own_a) + _correlation(b, own_b)
    crossed = _correlation(a, own_b) + _correlation(b, own_a)
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


def _pressures(rig: Rig, recording: Recording) -> list[Complaint]:
    """Pressures that are constant, or of another unit: the largest is near the supply's somewhere."""
    found = []
    supply = rig.value("supply.pressure")
    for joint in rig.joints:
        if rig.variant(joint, "cylinder") == "electric_motor":
            return []
    keys = [f"{joint}.{side}" for joint in rig.joints for side in ("pressure_a", "pressure_b")]
    for key in [k for k in (*keys, SUPPLY_KEY) if k in recording.signals]:
        values = np.asarray(recording.signal(key), dtype=float)
        if not np.isfinite(values).any():
            continue
        if np.nanmax(values) == np.nanmin(values):
            found.append(Complaint(key, f"is constant at {np.nanmax(values):.4g} Pa: no sensor there?", ""))
            continue
        ratio = max(float(np.nanmax(np.abs(values))), np.finfo(float).tiny) / supply
        slip = None
        if not PLAUSIBLE[0] < ratio < PLAUSIBLE[1]:
            off, called, has = min(UNITS["Pa"], key=lambda each: abs(math.log(ratio / each[0] / LARGEST)))
            slip = (called, has) if PLAUSIBLE[0] < ratio / off < PLAUSIBLE[1] else None
        if slip:
            read_as = slip[0].split(" column of ")[1]
            found.append(
                Complaint(
                    key,
                    f"reaches {np.nanmax(np.abs(values)):.3g} Pa where the supply has {supply:.3g} Pa: {slip[0]}?",
                    _column(key, read_as, slip[1]),
                )
            )
    return found


def _told(
    rig: Rig, joint: str, recording: Recording, volts: np.ndarray, position: np.ndarray
) -> list[Complaint]:
    """What the recording cannot tell, for want of motion."""
    found = []
    limit = rig.value(f"joints.{joint}.command.limit")
    centred = volts - rig.value(f"joints.{joint}.command.neutral")
    speed = _speed(recording.time, position)
    moving = speed[np.abs(speed) > 0.05 * np.nanmax(np.abs(speed))]
    turns = int(np.count_nonzero(np.diff(np.sign(moving))))
    if turns < REVERSALS:
        found.append(
            Complaint(
                position_key(rig, joint),
                f"reverses {turns} times: friction, play and leakage are not told apart; record {REVERSALS} reversals",
                "",
                wrong=False,
            )
        )
    if rig.needs_command(joint) and float(np.nanmax(np.abs(centred))) < SHARE_OF_COMMAND * limit:
        found.append(
            Complaint(
                f"{joint}.command",
                f"stays below {100 * SHARE_OF_COMMAND:g} % of its limit: full openings and the pump are not told",
                "",
                wrong=False,
            )
        )
    way = rig.value(f"joints.{joint}.load.upper_stop") - rig.value(f"joints.{joint}.load.lower_stop")
    moved = float(np.nanmax(position) - np.nanmin(position))
    if math.isfinite(way) and moved < SHARE_OF_TRAVEL * way:
        found.append(
            Complaint(
                position_key(rig, joint),
                f"moves over {100 * moved / way:.2g} % of the way between the stops: geometry and stops are not told",
                "",
                wrong=False,
            )
        )
    hydraulic = rig.variant(joint, "cylinder") != "electric_motor"
    if hydraulic and f"{joint}.pressure_a" not in recording.signals:
        found.append(
            Complaint(
                f"{joint}.pressure_a",
                "was not recorded: friction and load are told from motion alone",
                "",
                wrong=False,
            )
        )
    return found
