"""A law for physics in no list runs in the Diagram as in the rollout, from the rig that holds it."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from hydrolek_drake.diagnosis.structures.term_forms import Term, law_record, law_records, span_of
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rigs.machine.short_law import UNITS, terms_of
from hydrolek_drake.rollout.rollout import roll_out
from hydrolek_drake.station.simulation import command_source, initial_context, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes

TIMES = np.arange(0.0, 2.0, 0.01)
COMMAND = np.where(TIMES < 0.3, 0.0, 5.0 * np.sign(np.sin(2.0 * np.pi * 0.45 * (TIMES - 0.3))))
STEP = 2.5e-4

LAWS = {
    "command": (Term((), other="|x|"), 1.5),
    "amplifier": (Term((), time="t/T"), -0.5),
    "valve": (Term((), other="p_A"), 0.3),
    "supply": (Term((), speed="|v|"), -4e6),
    "cylinder": (Term((), place="((1 + z)/2)^2", speed="sign(v)"), -1500.0),
    "load": (Term((), place="near", speed="sign(v)", centre=-0.25, reach=0.5), -200.0),
    "sensor": (Term((), place="z^2"), 0.02),
    "capacity_a": (Term((), place="z"), 4e-13),
    "capacity_b": (Term((), other="p_B"), 4e-13),
    "back_a": (Term((), other="p_B"), -0.5),
    "back_b": (Term((), speed="v"), -0.4),
    "ramp": (Term(()), 0.02),
    "coil_time": (Term(()), 0.03),
    "flow_force": (Term(()), 0.43),
}


def _roll(rig, step=STEP):
    return roll_out(rig.records(), TIMES, COMMAND, TIMES, longest_step=step).signals


def _diagram(rig) -> np.ndarray:
    station = make_station(rig, sizes=StepSizes(step=STEP), command=command_source(TIMES, COMMAND[:, None]))
    start = np.array([rig.value("load.initial_position")])
    done = run(station, float(TIMES[-1]) + 0.01, context=initial_context(station, start))
    return done.signals["reading"][: TIMES.size, 0]


def _with_law(rig, rows, probe):
    length = "m" if rows[0]["at_rod"] else "rad"
    terms = terms_of(rows, (UNITS[probe].split("|")[0], length), "test", "test")
    return replace(rig, laws={rig.joints[0]: terms})


@pytest.fixture(scope="module")
def bench():
    rig = load_rig("joint_bench", {})
    return rig, span_of([_roll(rig)], rig.records()[0], 3.0, "rad")


@pytest.fixture(scope="module")
def apart_without(bench) -> float:
    """How far Diagram and rollout are apart without a law [rad]."""
    rig, _ = bench
    return float(np.abs(_diagram(rig) - _roll(rig).reading).max())


@pytest.mark.parametrize("probe", LAWS)
@pytest.mark.thorough(but=1)
def test_diagram_and_rollout_agree_on_a_law_at_every_stage(bench, apart_without, probe) -> None:
    rig, span = bench
    term, size = LAWS[probe]
    rig_with = _with_law(rig, law_record(probe, span, term, size), probe)
    told = _roll(rig_with).reading
    moved = np.abs(told - _roll(rig).reading).max()
    assert moved > np.radians(0.1), "the law must show for this to say anything"
    # both methods hold something over a step, a hundredth of the 25 ms in which a valve opens: 2 % of what the law does
    assert np.abs(_diagram(rig_with) - told).max() < apart_without + 0.02 * moved


def test_every_input_of_a_law_was_tried() -> None:
    assert set(LAWS) == set(UNITS) == set(PROBES) - {"flow"}


@pytest.mark.thorough
def test_a_law_of_terms_and_one_in_time_run_beside_an_effect(bench) -> None:
    rig, span = bench
    rocking = rig.with_values(
        {"effects.base.compliance.stiffness_Nm_per_rad": 8e4, "effects.base.compliance.inertia_kg_m2": 15.0}
    )
    friction = law_records(
        "cylinder",
        span,
        [Term((), speed="sign(v)"), Term((), place="z^2", speed="sign(v)")],
        [-400.0, -900.0],
    )
    ripple = law_record("supply", span, None, 2e6, 1e6, 1.7)
    terms = (
        _with_law(rig, friction, "cylinder").laws["joint"] + _with_law(rig, ripple, "supply").laws["joint"]
    )
    both = replace(rocking, laws={"joint": terms})
    told, plain = _roll(both).reading, _roll(rocking).reading
    moved = np.abs(told - plain).max()
    assert moved > np.radians(0.3)
    agree = np.abs(_diagram(rocking) - plain).max()
    assert np.abs(_diagram(both) - told).max() < agree + 0.02 * moved


def test_a_law_is_written_with_its_rig_and_runs_from_the_file(bench, tmp_path) -> None:
    rig, span = bench
    rows = np.concatenate(
        [
            law_record("cylinder", span, Term((), place="z", speed="sign(v)"), -1500.0),
            law_record("load", span, None, 10.0, -5.0, 1.3),
        ]
    )
    friction, shaking = (
        _with_law(rig, rows[i : i + 1], probe).laws["joint"] for i, probe in ((0, "cylinder"), (1, "load"))
    )
    held = replace(rig, laws={"joint": (*friction, *shaking)})
    path = tmp_path / "law.yaml"
    path.write_text(yaml.safe_dump(held.as_tree()))
    again = load_rig(path, {})
    assert again.laws == held.laws
    assert again.records().tobytes() == held.records().tobytes()
    assert set(again.laws["joint"][1].numbers) == {"sine", "cosine", "frequency"}  # what it needs, no more
    assert _roll(again).reading.tobytes() == _roll(held).reading.tobytes() != _roll(rig).reading.tobytes()
    given = roll_out(rig.records(), TIMES, COMMAND, TIMES, longest_step=STEP, law=rows).signals
    assert given.reading.tobytes() == _roll(held).reading.tobytes()
