"""The watch in sentences, and its limits."""

from collections.abc import Mapping, Sequence
from datetime import datetime, timezone

import numpy as np

from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.report.words import with_interval
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.errors import InputError
from hydrolek_drake.replay.display import display_factor, display_unit, shown
from hydrolek_drake.watching.alarms import UNLISTED
from hydrolek_drake.watching.asking import OWN_NUMBERS, EffectTold
from hydrolek_drake.watching.excitation import sentence
from hydrolek_drake.watching.limits import Limit
from hydrolek_drake.watching.trends import Trend, reached
from hydrolek_drake.watching.watch import Watched

DAY_S = 86400.0
"""Growth is told a day, since recordings are made over days."""


def day(seconds: float) -> str:
    """A moment as a date and time, or "never" where there is none."""
    if not np.isfinite(seconds) or not 0.0 <= seconds < 4e9:
        return "never"
    return datetime.fromtimestamp(seconds, timezone.utc).strftime("%Y-%m-%d %H:%M")


def title_of(effect: str) -> str:
    """What an effect is, in a few words."""
    if effect == OWN_NUMBERS:
        return "the machine's own parameters changed by more than the stated drift"
    if effect == UNLISTED:
        return "something that no single listed effect explains"
    return EFFECTS[effect].title


def size_text(told: EffectTold) -> str:
    """A size with its interval; an upper limit where nothing is within it."""
    return _size_text(told.size, told.low, told.high, told.unit)


def beside_text(told: EffectTold) -> str:
    """The same beside the effect that gains most; empty where none is surely there."""
    if told.beside_size is None or told.beside_low is None or told.beside_high is None:
        return ""
    return _size_text(told.beside_size, told.beside_low, told.beside_high, told.unit)


def _size_text(size: float, low: float, high: float, unit: str) -> str:
    if not np.isfinite(size) or not np.isfinite(high):
        return "nothing" if not np.isfinite(low) else f"above {shown(low, unit)}"
    value, begin, end = with_interval(Interval(size, low, high), unit)
    if low == 0.0 and high > 0.0:
        return f"at most {end}"
    return f"{value.partition(' ')[0]} ({begin} to {end})"


def latest(watched: Watched, effect: str, joint: str) -> EffectTold | None:
    """What the last recording says of an effect."""
    for answer in reversed(watched.answers):
        for told in answer.effects:
            if (told.effect, told.joint) == (effect, joint):
                return told
    return None


def headline(watched: Watched) -> str:
    """The outcome in one sentence."""
    count = len(watched.answers)
    if not count:
        return "No later recording could be evaluated."
    alarm = watched.alarm
    if alarm is None:
        beyond = [i for i, j in enumerate(watched.judgements) if j.beyond]
        since = watched.asked[beyond[-1]].stamp.iso if beyond and beyond[-1] == count - 1 else ""
        if since:
            return (
                f"No alarm yet: the last recording ({since}) is beyond its threshold, and one recording alone is no "
                "alarm."
            )
        return f"No alarm: in {count} recordings nothing differs from the reference beyond what chance gives."
    since = watched.asked[alarm.since].stamp.iso
    where = f" at {alarm.joint}" if alarm.joint else ""
    told = latest(watched, alarm.effect, alarm.joint)
    size = f", now {size_text(told)}" if told is not None and alarm.effect != OWN_NUMBERS else ""
    as_well = f" ({' or '.join(alarm.as_well)} explains as much)" if alarm.as_well else ""
    more = ""
    if alarm.unlisted and alarm.effect != UNLISTED:
        more = " Beside it something is left that no single listed effect explains."
    return f"Alarm since {since}: {title_of(alarm.effect)}{where}{size}{as_well}.{more}"


def growth_sentence(trend: Trend, unit: str) -> str:
    """How fast a size grows, and since when."""
    if trend.last is None:
        return "Too few recordings for a trend."
    factor, unit = DAY_S * display_factor(unit), display_unit(unit)
    low, high = (factor * v for v in trend.last.slope_interval)
    changed = ""
    if trend.changes:
        changed = (
            f"Its course changed at {', '.join(day(t) for t in trend.changes)}; since the last change it "
        )
    begun = changed or "It "
    per = f"{unit} a day" if unit != "1" else "a day"
    if not trend.moves:
        return f"{begun}does not grow beyond its uncertainty ({low:.3g} to {high:.3g} {per})."
    rate = factor * trend.last.slope
    return (
        f"{begun}{'grows' if rate > 0 else 'falls'} by {abs(rate):.3g} {per} (95 %: {low:.3g} to {high:.3g})."
    )


def limit_sentence(limit: Limit, trend: Trend, unit: str) -> str:
    """When a limit is reached."""
    what = shown(limit.size, unit)
    if trend.last is None:
        return f"Limit {what}: too few recordings for a forecast."
    when = reached(trend.last, limit.size)
    if not np.isfinite(when.earliest):
        return f"Limit {what}: the trend does not lead there."
    if when.latest <= trend.last.origin:
        return f"Limit {what}: reached."
    likeliest = f"{day(when.likeliest)}" if np.isfinite(when.likeliest) else "never by the likeliest trend"
    latest_ = day(when.latest) if np.isfinite(when.latest) else "no end"
    return f"Limit {what}: reached {likeliest} (95 %: {day(when.earliest)} to {latest_})."


def sentences(watched: Watched, limits: Sequence[Limit]) -> list[str]:
    """All that is told on a terminal."""
    told = [headline(watched)]
    alarm = watched.alarm
    named: dict[str, str] = {}
    if alarm is not None and alarm.joint:
        named[alarm.effect] = alarm.joint
    for name, joint in {**named, **_joints_of(watched, limits)}.items():
        trend, last = watched.trend(name, joint), latest(watched, name, joint)
        if last is None:
            continue
        told.append(f"{name}: {size_text(last)}. {growth_sentence(trend, last.unit)}")
        told += [f"  {limit_sentence(limit, trend, last.unit)}" for limit in limits if limit.effect == name]
    told += [each for each in [sentence(watched.told, watched.answers)] if each]
    told += [f"not evaluated: {each.recording}: {each.problem}" for each in watched.broken]
    return told


def _joints_of(watched: Watched, limits: Sequence[Limit]) -> Mapping[str, str]:
    """Effect of each limit -> the joint at which it acts.

    Raises:
        InputError: it is not among the effects that were asked for.
    """
    if not watched.answers:
        return {}
    joints: dict[str, str] = {}
    for told in watched.answers[-1].effects:
        joints.setdefault(told.effect, told.joint)
    for limit in limits:
        if limit.effect not in joints:
            raise InputError(
                f"--limit {limit.effect}={limit.size:g}: it is not evaluated on this rig; "
                f"evaluated are {', '.join(n for n in joints if n != OWN_NUMBERS)}"
            )
    return {limit.effect: joints[limit.effect] for limit in limits}
