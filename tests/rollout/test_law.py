"""Laws as feedback in the rollout: equal to the rig's own physics where that has the same equation."""

import numpy as np
import pytest

from hydrolek_drake.diagnosis.structures.term_forms import TERMS, Term, law_record, law_records, span_of
from hydrolek_drake.physics.law import NEAR, Seen, law_value
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.one_point import stroke_and_lever
from hydrolek_drake.rollout.rollout import Signals, roll_out

TIMES = np.arange(0.0, 6.0, 0.01)
COMMAND = np.where(TIMES < 0.5, 0.0, 6.0 * np.sin(2.0 * np.pi * 0.4 * (TIMES - 0.5)))
STEP = 2.5e-4


def _run(values=None, law=None, rig="joint_bench", probes=None) -> Signals:
    records = load_rig(rig, {}).with_values(values or {}).records()[:1]
    return roll_out(records, TIMES, COMMAND, TIMES, longest_step=STEP, law=law, probes=probes).signals


@pytest.fixture(scope="module")
def span():
    return span_of([_run()], load_rig("joint_bench", {}).records()[0], 6.0, "rad")


@pytest.mark.parametrize("probe", PROBES)
def test_a_law_of_size_zero_changes_nothing(probe: str, span) -> None:
    law = law_record(probe, span, TERMS[0], 0.0)
    assert _run(law=law).reading.tobytes() == _run().reading.tobytes()


def test_a_constant_law_is_a_constant_input(span) -> None:
    rows = np.zeros((2, len(PROBES)))
    rows[:, PROBES.index("valve")] = 0.1
    law = law_record("valve", span, Term((), time="1"), 0.1)
    assert _run(law=law).position == pytest.approx(_run(probes=(TIMES[-1], rows)).position, abs=1e-12)


def test_a_law_of_the_speed_at_the_load_is_its_damping(span) -> None:
    """M = -c w, against the rig's own."""
    more = 150.0
    law = law_record("load", span, Term((), speed="v"), -more * span.joint.speed)
    damped = _run({"load.damping": load_rig("joint_bench", {}).value("load.damping") + more})
    assert _run(law=law).position == pytest.approx(damped.position, abs=1e-9)
    assert np.abs(damped.position - _run().position).max() > 1e-4


def test_a_friction_as_a_law_holds_a_joint_as_the_listed_friction_does(span) -> None:
    """F = -F_c sign(v) at the rod, in the rod's own speed."""
    force = 1000.0
    listed = _run({"effects.cylinder.coulomb_friction.coulomb_N": force})
    told = _run(law=law_record("cylinder", span, Term((), speed="sign(v)"), -force))
    off = np.abs(listed.position - _run().position).max()
    assert off > np.radians(0.3)
    assert np.abs(told.position - listed.position).max() < 1e-6 * off


def test_terms_of_a_law_add_up(span) -> None:
    """M = -c w - m at the load: the rig's damping and a constant moment."""
    more, constant = 150.0, -40.0
    laws = law_records("load", span, (Term((), speed="v"), Term(())), (-more * span.joint.speed, constant))
    rows = np.zeros((2, len(PROBES)))
    rows[:, PROBES.index("load")] = constant
    damping = load_rig("joint_bench", {}).value("load.damping") + more
    same = _run({"load.damping": damping}, probes=(TIMES[-1], rows))
    assert _run(law=laws).position == pytest.approx(same.position, abs=1e-9)


def test_a_law_in_the_hydraulics_sees_the_rod_and_at_the_load_the_joint(span) -> None:
    """Half of the bench's movement lies not at half of its stroke, since its lever changes."""
    joint = load_rig("joint_bench", {}).records()[0]
    middle = 0.5 * (span.joint.low + span.joint.high)
    stroke, lever = stroke_and_lever(middle, joint)
    seen = Seen(0.0, middle, 0.1, stroke, lever * 0.1, 0.0, 0.0, 0.0)
    term = Term((), place="z")
    at_load, at_rod = (law_record(probe, span, term, 1.0)[0] for probe in ("load", "cylinder"))
    assert law_value(at_load, seen) == pytest.approx(0.0, abs=1e-12)
    reach = span.rod.high - span.rod.low
    assert law_value(at_rod, seen) == pytest.approx(2.0 * (stroke - span.rod.low) / reach - 1.0)
    assert abs(law_value(at_rod, seen)) > 0.01


def test_friction_towards_one_end_is_on_the_rods_side(span) -> None:
    """What brakes extension raises the pressure on the bore side, whichever way the joint turns."""
    law = law_record("cylinder", span, Term((), speed="sign(v)"), -2000.0)
    told, plain = _run(law=law), _run()
    extending = COMMAND > 4.0
    assert np.median((told.pressure_a - plain.pressure_a)[extending]) > 0.0


def test_a_periodic_law_is_a_sine_in_time(span) -> None:
    law = law_record("supply", span, None, 1e6, 5e5, 1.7)
    grid = np.arange(0.0, 6.1, 5e-4)
    rows = np.zeros((grid.size, len(PROBES)))
    angle = 2.0 * np.pi * 1.7 * grid
    rows[:, PROBES.index("supply")] = 1e6 * np.sin(angle) + 5e5 * np.cos(angle)
    as_series = _run(probes=(5e-4, rows))
    assert _run(law=law).position == pytest.approx(as_series.position, abs=1e-7)


def test_places_add_up_to_the_whole_movement(span) -> None:
    """Windows of cosine squared half their width apart: 1 wherever two of them meet."""
    low, high = span.joint.low, span.joint.high
    for reach in (0.5, 0.2):
        places = np.arange(-0.75, 0.75, reach)
        terms = [Term((), place=NEAR, centre=at, reach=reach) for at in places]
        laws = law_records("load", span, terms, [1.0] * len(terms))
        for z in np.linspace(places[0], places[-1], 11):
            seen = Seen(0.0, low + 0.5 * (1.0 + z) * (high - low), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            assert sum(law_value(row, seen) for row in laws) == pytest.approx(1.0)
    beyond = Seen(0.0, high, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert (
        law_value(law_record("load", span, Term((), place=NEAR, centre=0.25, reach=0.5), 1.0)[0], beyond)
        == 0.0
    )


def test_every_term_is_of_size_about_one_where_it_was_defined(span) -> None:
    run = _run()
    for term in TERMS:
        law = law_record("load", span, term, 1.0)[0]
        rows = zip(
            run.time, run.position, run.velocity, run.pressure_a, run.pressure_b, run.spool, strict=True
        )
        values = [law_value(law, Seen(t, q, w, 0.0, 0.0, *rest)) for t, q, w, *rest in rows]
        assert 0.3 <= np.abs(values).max() <= 2.0, term.name


@pytest.mark.parametrize("probe", ["cylinder", "load"])
def test_strong_friction_in_a_law_stays_stable_at_the_rigs_step(probe: str, span) -> None:
    """Ten times the supply's force would oscillate with an explicit step; the joint must be held instead."""
    size = {"cylinder": 2e5, "load": 4e4}[probe]
    law = law_record(probe, span, Term((), speed="sign(v)"), -size)
    held = _run(law=law)
    assert np.isfinite(held.position).all()
    assert np.ptp(held.position) < 0.05 * np.ptp(_run().position)


def test_a_machine_without_oil_takes_laws_too() -> None:
    plain = roll_out(load_rig("emps", {}).records(), TIMES, 0.3 * COMMAND, TIMES, longest_step=STEP).signals
    rig = load_rig("emps", {})
    span = span_of([plain], rig.records()[0], 6.0, "m")
    assert span.joint.slow == pytest.approx(rig.value("load.friction_velocity"))
    law = law_record("load", span, Term((), speed="sign(v)"), -20.0)
    told = roll_out(rig.records(), TIMES, 0.3 * COMMAND, TIMES, longest_step=STEP, law=law).signals
    listed = rig.with_values({"effects.load.coulomb_friction.force_N": 20.0}).records()
    same = roll_out(listed, TIMES, 0.3 * COMMAND, TIMES, longest_step=STEP).signals
    assert told.position == pytest.approx(same.position, abs=1e-9)
