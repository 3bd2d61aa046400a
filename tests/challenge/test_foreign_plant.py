"""The simulator of foreign machines against closed forms of its physics."""

import math

import numpy as np
import pytest

from hydrolek_drake.challenge.foreign.building import built, noises, numbers, places
from hydrolek_drake.challenge.foreign.drawing import Foreign, draw_foreign, labels_of
from hydrolek_drake.challenge.foreign.equations import (
    Played,
    at_rest,
    edge_flow,
    packed_at,
    played,
    pressure_of,
    reach,
)
from hydrolek_drake.challenge.foreign.plant import Plant
from hydrolek_drake.challenge.foreign.sheets import data_sheet
from hydrolek_drake.wizard.making import written_rig


def machine(kind: str = "press", **changes: float) -> Plant:
    """A machine of a kind, as its catalogue has it but for changes."""
    own = numbers()
    own = {**own, "spread": 1.0, "common": {**own["common"], "dead_volume_differs": 0.0}}
    return built(own, kind, np.random.default_rng(1))[1]._replace(**changes)


START = {"press": 0.15, "feed": 0.25, "wrist": math.radians(5.0), "slewing": 0.0, "boom": math.radians(10.0)}


def course(kind: str, plant: Plant, *commands: tuple[float, float]) -> Played:
    """What it does under voltages that last so many seconds each."""
    series = np.concatenate([np.full(round(100 * seconds), volts) for volts, seconds in commands])
    return played(plant, series, START[kind])


@pytest.mark.parametrize("air", [0.0, 0.02])
def test_pressure_follows_from_mass_as_mass_from_pressure(air: float) -> None:
    """One undoes the other, from nothing to 30 MPa."""
    plant = machine(air=air)
    for p in (1e3, 1e5, 5e6, 3e7):
        assert pressure_of(plant, packed_at(plant, p) * 2e-4, 2e-4) == pytest.approx(p, rel=1e-6)


def test_oil_that_does_not_fill_its_room_has_no_pressure() -> None:
    """A void, not tension."""
    plant = machine()
    assert pressure_of(plant, 0.9 * plant.density * 1e-4, 1e-4) == 0.0


def test_bubbles_soften_the_oil_as_their_gas_law_says() -> None:
    """Compliance d ln(mass) / dp of a mixture, in closed form at a pressure."""
    plant = machine(air=0.02)
    p, dp = 1e6, 1e2
    ratio = 101325.0 / (101325.0 + p)
    gas = 0.02 * ratio ** (1.0 / plant.gas_exponent)
    liquid = 0.98 * math.exp(-p / plant.bulk)
    expected = (liquid / plant.bulk + gas / (plant.gas_exponent * (101325.0 + p))) / (liquid + gas)
    found = (math.log(packed_at(plant, p + dp)) - math.log(packed_at(plant, p - dp))) / (2.0 * dp)
    assert found == pytest.approx(expected, rel=1e-5)


def test_an_edge_gives_its_rated_flow_at_its_rated_drop() -> None:
    """Fully open, as the data sheet says."""
    own = numbers()
    plant = machine()
    rated = own["kinds"]["press"]["rated_flow_l_min"][0] / 6e4
    drop = 1e5 * own["common"]["rated_drop_bar"]
    flow = edge_flow(plant, plant.width[0], plant.travel - plant.overlap, drop)
    assert flow == pytest.approx(rated, rel=0.005)
    assert edge_flow(plant, plant.width[0], plant.travel - plant.overlap, -drop) == pytest.approx(-flow)


def test_an_edge_that_is_hardly_open_is_laminar() -> None:
    """Flow goes with the drop, not with its root."""
    plant = machine(rounding=1e-9)
    little, more = (edge_flow(plant, plant.width[0], 2e-6, drop) for drop in (1e4, 2e4))
    assert more / little == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize("kind", list(START))
def test_levers_are_the_slope_of_the_stroke(kind: str) -> None:
    """Difference quotients at three places."""
    plant = machine(kind)
    for at in places(plant, (0.1, 0.5, 0.9)):
        slope = (reach(plant, at + 1e-6)[0] - reach(plant, at - 1e-6)[0]) / 2e-6
        assert reach(plant, at)[1] == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("kind", list(START))
def test_nothing_moves_without_a_command(kind: str) -> None:
    """Edges overlap, so that what is in balance stays there."""
    done = course(kind, machine(kind), (0.0, 2.0))
    assert np.ptp(done.reading) < 1e-7
    assert np.ptp(done.pressure_a) < 1e-4 * done.pressure_a[0]


def test_a_slide_reaches_the_speed_of_its_orifices() -> None:
    """Both edges in series with the piston's areas, in closed form, the seals' and guides' friction as the load."""
    plant = machine()
    done = course("press", plant, (0.0, 0.1), (4.0, 0.6))
    speed = (done.reading[-1] - done.reading[-11]) / 0.1
    opening = 0.4 * plant.travel - plant.overlap
    drop_in = plant.setting - done.pressure_a[-1]
    drop_out = done.pressure_b[-1] - plant.tank
    jet_in, jet_out = (math.sqrt(2.0 * drop / plant.density) for drop in (drop_in, drop_out))
    assert plant.area_a * speed == pytest.approx(
        plant.discharge * plant.width[0] * opening * jet_in, rel=0.01
    )
    assert plant.area_b * speed == pytest.approx(
        plant.discharge * plant.width[3] * opening * jet_out, rel=0.01
    )
    force = plant.area_a * done.pressure_a[-1] - plant.area_b * done.pressure_b[-1]
    assert force == pytest.approx((plant.damping + plant.seal_damping) * speed, rel=0.05)


def test_the_pump_gives_what_it_has_and_no_more() -> None:
    """Wide open, a slide moves by the pump's flow less its leakage."""
    plant = machine("feed")
    plant = plant._replace(pump=0.3 * plant.pump)
    done = course("feed", plant, (0.0, 0.1), (10.0, 0.9))
    speed = (done.reading[-1] - done.reading[-21]) / 0.2
    given = plant.pump - plant.pump_leak * done.supply[-1]
    assert plant.area_a * speed == pytest.approx(given, rel=0.01)
    assert done.supply[-1] < 0.9 * plant.setting


def test_the_relief_valve_holds_the_line_at_rest() -> None:
    """Where it lets all of the pump's flow off."""
    plant = machine("feed")
    y = at_rest(plant, START["feed"])
    off = plant.pump * y[7] * math.sqrt(y[6] / plant.setting)
    assert off == pytest.approx(plant.pump - plant.pump_leak * y[6], rel=1e-9)
    done = course("feed", plant, (0.0, 1.0))
    assert np.ptp(done.supply) < 1.0


def test_what_leaks_past_the_piston_moves_it() -> None:
    """What leaks into a chamber moves the piston and presses the oil; on the way the load moves either way."""
    plant = machine("boom")
    plant = plant._replace(leak=1e-12)
    done = course("boom", plant, (0.0, 3.0))
    stroke = np.array([reach(plant, at)[0] for at in done.reading])
    pressed = (plant.dead_a + plant.area_a * stroke) / plant.bulk * np.gradient(done.pressure_a, 0.01)
    past = plant.leak * (done.pressure_a - done.pressure_b)
    moved = plant.area_a * np.gradient(stroke, 0.01)
    assert np.mean((moved + pressed)[100:250]) == pytest.approx(-np.mean(past[100:250]), rel=0.02)


def test_dry_friction_holds_until_it_breaks_away() -> None:
    """A slide stands while the chambers push with less than its friction, and creeps by its bristles alone."""
    plant = machine("press", coulomb=3000.0, static=2000.0)
    y = at_rest(plant, 0.15)
    push = plant.area_a * 1e6
    y[2] = packed_at(plant, 1e6 + plant.area_b / plant.area_a * 0.5 * plant.setting) * (
        plant.dead_a + plant.area_a * 0.15
    )
    assert push < 5000.0
    done = course("press", plant, (0.0, 1.0), (1.2, 0.3), (6.0, 0.3))
    assert np.ptp(done.reading[:100]) < 1e-5
    assert np.ptp(done.reading[130:]) > 0.01


def test_a_play_lets_the_load_lag_by_its_gap() -> None:
    """A slide that is drawn to and fro against its guides lags by half of the gap each way."""
    gap = 0.004
    sound = machine("press", damping=8000.0)
    loose = sound._replace(gap=gap)
    commands = ((0.0, 0.2), (3.0, 0.8), (0.0, 0.5), (-3.0, 0.8), (0.0, 0.5))
    there = [course("press", plant, *commands) for plant in (sound, loose)]
    lag = there[0].reading - there[1].reading
    out, back = lag[99], lag[229]
    assert out - back == pytest.approx(gap, rel=0.1)


@pytest.mark.parametrize("kind", ["boom", "wrist"])
def test_a_load_that_hangs_in_its_play_begins_in_balance(kind: str) -> None:
    """Its chambers carry the load at the stroke of the rod's side, from the first sample on."""
    plant = machine(kind)
    plant = plant._replace(gap=math.radians(0.5))
    done = course(kind, plant, (0.0, 0.5))
    assert np.ptp(done.pressure_a) < 1e-3 * done.pressure_a[0]
    assert np.ptp(done.reading) < math.radians(1e-3)


def test_half_of_the_step_changes_nothing_that_is_seen() -> None:
    """The noise is a hundred times larger, for every kind of machine and for a play."""
    own = numbers()
    rng = np.random.default_rng(3)
    for kind in START:
        for plant in (machine(kind), machine(kind, coulomb=300.0, static=300.0)):
            series = np.repeat(rng.uniform(-5.0, 5.0, 6), 50)
            coarse, fine = (played(plant, series, START[kind], step=step) for step in (2e-5, 1e-5))
            noise = noises(own, plant.turns > 0.5)[0]
            assert np.max(np.abs(coarse.reading - fine.reading)) < 0.01 * noise


@pytest.mark.thorough(but=("wrist",))
@pytest.mark.parametrize("kind", list(START))
def test_data_sheets_are_wrong_and_still_make_rigs(kind: str) -> None:
    """Each number by up to 30 %, one by a factor of two, and the wizard writes a rig that loads."""
    own = numbers()
    rng = np.random.default_rng(len(kind))
    base, _ = built(own, kind, rng)
    sheet, wrong = data_sheet(own, base, rng)
    twice = [key for key, by in wrong.items() if by in (0.5, 2.0)]
    assert len(twice) == 1
    assert all(1.0 / 1.3 <= by <= 1.3 for key, by in wrong.items() if key not in twice)
    _, rig = written_rig("foreign", sheet)
    assert list(rig.joints) == ["joint"]


@pytest.fixture(scope="module")
def drawn() -> list[Foreign]:
    """The cases of one machine."""
    return draw_foreign(1, 5)


@pytest.mark.thorough
def test_drawn_again_is_the_same(drawn: list[Foreign]) -> None:
    """One seed, one set of labels."""
    assert labels_of(draw_foreign(1, 5)) == labels_of(drawn)


def test_half_of_the_cases_conceal_nothing_and_the_others_something_that_shows(drawn: list[Foreign]) -> None:
    """As much as was asked for, or all that a pump can lose."""
    assert [bool(case.conceals) for case in drawn] == [False, False, True, True]
    low, high = numbers()["shows"]
    for case in drawn[2:]:
        assert case.shows > 0.75 * low
        assert case.shows < high / 0.75 or "supply.pump_loss" in case.conceals
