"""Joints that move together: the compiled rollout moves as the Diagram does, and as a joint alone where it is alone."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.structures.term_forms import Reach, Span, Term, law_record
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rigs.machine.short_law import terms_of
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.together.arms import moving_with
from hydrolek_drake.rollout.together.together import JointsTogether
from hydrolek_drake.station.simulation import command_source, initial_context, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes

pytestmark = pytest.mark.xdist_group("joints together")

MOVING = ("right_j2", "right_j3")
TIME = np.arange(0.0, 4.0 + 0.005, 0.01)
ALLOWED_DEG = 0.02
"""What the rollout's own step may cost (hydrolek.yaml)."""


def _volts(joints: int, seed: int = 4) -> np.ndarray:
    rng = np.random.default_rng(seed)
    volts = np.repeat(rng.uniform(-3.0, 3.0, (9, joints)), 50, axis=0)[: TIME.size]
    volts[:50] = 0.0
    return volts


def _off_deg(
    rig: Rig, step: float | None = None, joints: tuple[str, ...] = MOVING, seconds: float = 3.0
) -> np.ndarray:
    """Largest difference of each joint's reading between the rollout of all and the Diagram."""
    volts, records, times = _volts(len(joints)), rig.records(), TIME[TIME <= seconds]
    places = records["load"]["initial_position"]
    station = make_station(rig, command=command_source(TIME, volts), sizes=StepSizes(step=2.5e-4))
    wanted = run(station, seconds, context=initial_context(station, places)).signals["reading"]
    done = JointsTogether(rig, joints).roll_out(records, TIME, volts, times, places, step)
    assert done.diverged is None
    return np.degrees(np.abs(done.signals["reading"] - wanted[: times.size]).max(axis=0))


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"joints.right_j2.effects.supply.pressure_droop.resistance_Pa_s_per_m3": 3e10},
        {
            "joints.right_j2.effects.load.payload.mass_kg": 15.0,
            "joints.right_j2.effects.load.payload.time_s": 1.7,
        },
        {
            "joints.right_j3.effects.cylinder.coulomb_friction.coulomb_N": 2000.0,
            "joints.right_j2.effects.valve.null_leakage.conductance_m3_per_s_Pa": 1e-13,
        },
        {
            "joints.right_j3.effects.cylinder.coulomb_friction.coulomb_N": 2000.0,
            "joints.right_j3.cylinder.bristle_deflection": 3e-5,
            "joints.right_j3.cylinder.bristle_time": 3e-4,
        },
        {"joints.right_j2.effects.base.compliance.stiffness_Nm_per_rad": 2e5},
        {"joints.right_j2.effects.linkage.backlash.gap_rad": 0.005},
    ],
    ids=["healthy", "droop", "payload", "friction and leak", "bristles", "rocking base", "play"],
)
@pytest.mark.thorough(but=1)
def test_joints_move_as_in_the_diagram(two_joints, values) -> None:
    # contacts, as in docs/evidence/agreement.md
    step = 1e-4 if any("backlash" in path for path in values) else None
    assert _off_deg(two_joints.with_values(values), step).max() < ALLOWED_DEG


def test_both_arms_move_as_in_the_diagram() -> None:
    droop = "joints.right_j1.effects.supply.pressure_droop.resistance_Pa_s_per_m3"
    whole = load_rig("hydrolek", {}).with_values({droop: 3e10})
    assert _off_deg(whole, joints=whole.joints, seconds=1.5).max() < ALLOWED_DEG


@pytest.mark.thorough
def test_joints_on_one_pump_move_as_in_the_diagram(on_a_pump) -> None:
    assert _off_deg(on_a_pump).max() < ALLOWED_DEG
    records, setting = on_a_pump.records(), on_a_pump.value("supply.pressure")
    places = records["load"]["initial_position"]
    done = JointsTogether(on_a_pump, MOVING).roll_out(records, TIME, _volts(2), TIME, places)
    pressure = done.signals["supply_pressure"]
    assert pressure.min() < 0.9 * setting < setting < pressure.max()  # relief valve closed, and open
    np.testing.assert_array_equal(pressure[:, 0], pressure[:, 1])


@pytest.mark.long("a quarter of a minute: loops with laws are compiled")
def test_laws_of_two_joints_act_as_in_the_diagram(two_joints) -> None:
    span = Span(Reach(1.0, 1.0, 0.0, 0.3, "rad"), None, 1.0, 1.0, 1.0)
    droops = law_record("supply", span, Term((), speed="|v|"), -2e6)  # of the pump that feeds both
    shakes = law_record("load", span, None, 300.0, 0.0, 1.3)
    laws = {
        joint: terms_of(rows, (unit, "rad"), "planted", "planted")
        for joint, rows, unit in zip(MOVING, (droops, shakes), ("Pa", "N m"), strict=True)
    }
    rig = replace(two_joints, laws=laws)
    assert _off_deg(rig).max() < ALLOWED_DEG
    shaken = replace(rig, laws={MOVING[1]: laws[MOVING[1]]})
    places = rig.records()["load"]["initial_position"]
    drooping, steady = (
        JointsTogether(two_joints, MOVING)
        .roll_out(r.records(), TIME, _volts(2), TIME, places)
        .signals["reading"]
        for r in (rig, shaken)
    )
    moved = np.degrees(np.abs(drooping - steady).max(axis=0))
    assert moved.min() > 10.0 * ALLOWED_DEG  # what one joint's speed takes from the pump, both feel


def test_a_joint_that_moves_alone_moves_as_in_its_own_rollout(two_joints) -> None:
    volts, records = _volts(1), two_joints.records()
    alone = load_rig("hydrolek_right_j2", {})
    start = rest_state(alone.records(), 0.2)
    wanted = roll_out(
        alone.records(),
        TIME,
        volts[:, 0],
        TIME,
        state=start,
        longest_step=alone.value("integration.longest_step"),
        spool_steps=round(alone.value("integration.spool_steps")),
    ).signals
    done = JointsTogether(two_joints, MOVING[:1]).roll_out(records, TIME, volts, TIME, np.array([0.2]))
    assert done.signals["reading"][:, 0] == pytest.approx(wanted.reading, abs=1e-9)
    assert done.signals["pressure_a"][:, 0] == pytest.approx(wanted.pressure_a, rel=1e-6)


def test_a_joint_of_no_arm_moves_as_in_its_own_rollout() -> None:
    bench, volts = load_rig("joint_bench", {}), _volts(1)
    records, step = bench.records(), bench.value("integration.longest_step")
    start = np.array([bench.value("load.initial_position")])
    spool_steps = round(bench.value("integration.spool_steps"))
    wanted = roll_out(records, TIME, volts[:, 0], TIME, longest_step=step, spool_steps=spool_steps).signals
    done = JointsTogether(bench, bench.joints).roll_out(records, TIME, volts, TIME, start)
    for name in ("reading", "pressure_a", "spool", "force"):
        assert done.signals[name][:, 0] == pytest.approx(getattr(wanted, name), rel=1e-9, abs=1e-12), name


def test_its_error_falls_with_the_square_of_the_step(two_joints) -> None:
    volts, records = _volts(2), two_joints.records()
    machine, places = JointsTogether(two_joints, MOVING), records["load"]["initial_position"]

    def reading(step: float) -> np.ndarray:
        return machine.roll_out(records, TIME, volts, TIME, places, step).signals["reading"]

    exact = reading(1e-5)
    coarse, fine = (np.sqrt(np.mean((reading(h) - exact) ** 2)) for h in (2e-4, 1e-4))
    assert 3.0 < coarse / fine < 5.5


def test_joints_of_an_arm_give_way_and_those_of_the_other_do_not() -> None:
    whole = load_rig("hydrolek", {})
    assert moving_with(whole, ["right_j3"]) == tuple(f"right_j{n}" for n in range(1, 8))
    bench = load_rig("joint_bench", {})
    assert moving_with(bench, bench.joints) == bench.joints


@pytest.mark.parametrize(
    ("value", "said"), [(0.0, "divided is zero"), (np.nan, "cylinder.area_a is not a number")]
)
def test_a_number_that_cannot_be_is_an_outcome_with_a_reason(two_joints, value, said) -> None:
    records = two_joints.records()
    records[1]["cylinder"]["area_a"] = value
    places = records["load"]["initial_position"]
    done = JointsTogether(two_joints, MOVING).roll_out(records, TIME, _volts(2), TIME, places)
    assert done.diverged is not None and said in done.diverged
    assert np.isnan(done.signals["reading"]).all()


def test_a_divergence_is_told_with_its_time(two_joints) -> None:
    records = two_joints.with_values({"supply.pressure": 1e16}).records()
    places = records["load"]["initial_position"]
    done = JointsTogether(two_joints, MOVING).roll_out(records, TIME, _volts(2), TIME, places)
    assert done.diverged is not None
    assert "left all bounds at" in done.diverged
    assert np.isnan(done.signals["reading"][-1]).all()
