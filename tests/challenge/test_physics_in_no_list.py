"""What the concealed machines have that is in no list does what its name says, on the bench and on an arm alike."""

import functools
import math

import numpy as np
import pytest

from hydrolek_drake.challenge.build import Build, build_of
from hydrolek_drake.challenge.driving import SAMPLE_S, Played, random_series
from hydrolek_drake.challenge.faulty_signals import lost
from hydrolek_drake.challenge.machine_parts import let_out
from hydrolek_drake.rigs import load_rig

RIGS = ("joint_bench", "hydrolek_left_j3")
STEP_S = 1e-4
MODERATE_V = {"joint_bench": 2.0, "hydrolek_left_j3": 1.5}
"""Moves a joint for a second without leading it into a stop, its valve not fully open."""

SMALL_DEG = 0.02
"""Less than half of either sensor's noise."""


@functools.cache
def _build(name: str) -> Build:
    return build_of(load_rig(name, {}))


def _size(build: Build, name: str, times: float = 1.0) -> dict[str, float]:
    entry = build.unlisted[name]
    drawn = {p: math.sqrt(low * high) for p, (low, high) in entry.get("draw", {}).items()}
    return {p: v * times for p, v in entry["size"].items()} | drawn


def _volts(build: Build, seconds: float = 8.0) -> np.ndarray:
    return random_series(build.driving, False, seconds, np.random.default_rng(4))


def _driven(build: Build, volts: np.ndarray, **strange: float) -> Played:
    concealed = build.nominal.concealed._replace(**strange)
    return build.replay(build.nominal._replace(concealed=concealed), volts, STEP_S)


def _rms_deg(values: np.ndarray) -> float:
    return float(np.degrees(np.sqrt(np.mean(values**2))))


@pytest.mark.long("a quarter of a minute")
@pytest.mark.parametrize("rig", RIGS)
def test_every_kind_changes_what_the_machine_does(rig: str) -> None:
    build = _build(rig)
    volts = _volts(build, 40.0)
    plain = _driven(build, volts)
    for name in build.unlisted:
        changed = _driven(build, volts, **_size(build, name))
        assert _rms_deg(changed.reading - plain.reading) > SMALL_DEG, name


@pytest.mark.parametrize("rig", RIGS)
def test_a_ramp_is_the_command_ramped_by_hand(rig: str) -> None:
    build = _build(rig)
    wanted = np.repeat([0.0, 4.0, -4.0, 0.0], [50, 150, 150, 50])
    rate = 20.0
    ramped = wanted.copy()
    for n in range(1, wanted.size):  # held for a sample each, half a sample late in the mean
        ramped[n] = np.clip(wanted[n], ramped[n - 1] - rate * SAMPLE_S, ramped[n - 1] + rate * SAMPLE_S)
    at_once = _driven(build, wanted)
    by_the_card = _driven(build, wanted, ramp_v_per_s=rate)
    by_hand = _driven(build, ramped)
    parted = _rms_deg(by_the_card.reading - at_once.reading)
    assert _rms_deg(by_the_card.reading - by_hand.reading) < 0.1 * parted


def test_a_command_is_lost_for_its_share_of_the_time_and_never_at_regular_times() -> None:
    machine = _build("joint_bench").nominal.concealed._replace(lost_s=0.2, lost_every_s=5.0)
    times = np.arange(0.0, 500.0, 0.01)
    gone = np.array([lost(machine, t) for t in times])
    assert gone.mean() == pytest.approx(0.2 / 5.0, rel=0.03)
    began = times[1:][gone[1:] & ~gone[:-1]]
    assert np.ptp(np.diff(began)) > 2.0
    assert not any(lost(machine._replace(lost_s=0.0), t) for t in times[:1000].tolist())


@pytest.mark.parametrize("rig", RIGS)
def test_a_command_that_is_always_lost_moves_nothing(rig: str) -> None:
    build = _build(rig)
    still = _driven(build, np.zeros(300))
    gone = _driven(build, np.full(300, 4.0), lost_s=1.0, lost_every_s=1.0)
    assert np.array_equal(gone.reading, still.reading)


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_flow_force_closes_the_spool_both_ways(rig: str, direction: float) -> None:
    build = _build(rig)
    volts = np.r_[np.zeros(50), np.full(100, MODERATE_V[rig] * direction)]
    plain, slowed = _driven(build, volts), _driven(build, volts, **_size(build, "valve.flow_force"))
    travelled = direction * (plain.reading[-1] - plain.reading[0])
    assert travelled > math.radians(2.0)
    assert direction * (slowed.reading[-1] - slowed.reading[0]) < 0.99 * travelled


@pytest.mark.parametrize("rig", RIGS)
def test_a_return_line_is_a_tank_under_the_pressure_of_its_flow(rig: str) -> None:
    """At a steady speed the oil that leaves is area times rod speed, so the tank stands so much higher."""
    build = _build(rig)
    volts = np.r_[np.zeros(50), np.full(100, MODERATE_V[rig])]
    line = _size(build, "supply.return_line", 3.0)
    late = slice(-40, -10)
    plain, slowed = _driven(build, volts), _driven(build, volts, **line)
    higher = line["return_pa_s"] * _leaving(build, slowed.reading[late])
    same = build.replay(build.nominal._replace(p_t=build.nominal.p_t + higher), volts, STEP_S)
    assert higher > 2e5
    speeds = [float(np.ptp(done.reading[late])) for done in (plain, slowed, same)]
    assert speeds[1] < 0.995 * speeds[0]
    assert speeds[1] == pytest.approx(speeds[2], abs=0.05 * (speeds[0] - speeds[1]))


def _leaving(build: Build, reading: np.ndarray) -> float:
    """Mean flow to the tank while a joint moves [m^3/s]: area times rod speed of the side that empties."""
    machine = build.nominal
    if build.rig.name == "joint_bench":
        near, far, turned = machine.a, machine.b, reading + machine.phi
    else:
        near, far, turned = machine.mount_c, machine.mount_p, machine.direction * reading + machine.offset
    length = np.sqrt(near**2 + far**2 - 2.0 * near * far * np.cos(turned))
    speed = float(length[-1] - length[0]) / ((length.size - 1) * SAMPLE_S)
    return machine.a_b * speed if speed > 0.0 else -machine.a_a * speed


@pytest.mark.parametrize("rig", RIGS)
def test_a_counterbalance_valve_slows_the_way_in_and_not_the_way_out(rig: str) -> None:
    """Oil leaves side A where the rod goes in; held wholly, it opens by what both chambers' pressures lift."""
    build = _build(rig)
    valve = {"held": 1.0, "holding_pa": 5e7}
    concealed = build.nominal.concealed._replace(**valve)
    assert let_out(concealed, 5e6, 5e6) == pytest.approx((5e6 + 3.0 * 5e6) / 5e7)
    assert let_out(concealed, 5e7, 0.0) == let_out(build.nominal.concealed, 5e6, 5e6) == 1.0
    out, back = (np.r_[np.zeros(50), np.full(100, sign * MODERATE_V[rig])] for sign in (1.0, -1.0))
    assert np.array_equal(_driven(build, out, **valve).reading, _driven(build, out).reading)
    plain, held = _driven(build, back), _driven(build, back, **valve)
    open_share = let_out(concealed, held.pressure_a[-1], held.pressure_b[-1])
    slower = []
    for done in (
        plain,
        held,
    ):  # speed per root of the pressure that drives the oil out, where the motion is steady
        drop = done.pressure_a[-10:].mean() - build.nominal.p_t
        slower.append((done.reading[-1] - done.reading[-10]) / math.sqrt(drop))
    assert open_share < 0.95
    assert slower[1] / slower[0] == pytest.approx(open_share, rel=0.02)


@pytest.mark.parametrize("rig", RIGS)
def test_hoses_that_are_tight_at_the_start_are_held_by_the_oil(rig: str) -> None:
    build = _build(rig)
    plain = _driven(build, np.zeros(100))
    tight = _driven(build, np.zeros(100), snag_nm_per_rad=100.0, snag_at=0.0)
    assert np.ptp(tight.reading) < math.radians(SMALL_DEG)
    assert tight.pressure_a[0] != pytest.approx(plain.pressure_a[0], rel=1e-3)


@pytest.mark.parametrize("rig", RIGS)
def test_a_worn_track_is_read_wrong_there_and_nowhere_else(rig: str) -> None:
    build = _build(rig)
    volts = _volts(build, 20.0)
    plain = _driven(build, volts)
    low, high = (build.rig.value(f"load.{end}_stop") for end in ("lower", "upper"))
    share = (plain.reading - low) / (high - low)
    at = float(np.median(share))
    changed = _driven(build, volts, worn_rad=0.02, worn_at=at, worn_wide=0.1)
    wanted = 0.02 * np.exp(-(((share - at) / 0.1) ** 2))
    assert wanted.max() > 0.015
    assert changed.reading - plain.reading == pytest.approx(wanted, abs=1e-6)
