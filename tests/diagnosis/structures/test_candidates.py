"""Which effects are candidates on which machine, and how far each is searched."""

import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.effects.scales import SLOWED, Scales, hydraulic_scales
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import ParameterSet, free_of_joints
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.one_point import stroke_and_lever

ON_THE_BENCH = {
    "command.delay", "amplifier.gain_fade", "valve.asymmetric_overlap", "valve.spool_stiction", "valve.null_leakage",
    "supply.pressure_droop", "fluid.entrained_air", "fluid.warm_up", "cylinder.cross_port_leakage",
    "cylinder.coulomb_friction", "cylinder.stribeck_friction", "cylinder.end_cushion", "linkage.backlash",
    "base.compliance", "sensor.nonlinearity", "sensor.hysteresis", "sensor.drift",
}  # fmt: skip


def test_every_effect_of_the_bench_is_a_candidate_there(bench, recorded) -> None:
    ids = {
        c.id for c in candidates_of(bench, "joint", natural_scales(bench, "joint", recorded(bench, bench)))
    }
    assert ids >= ON_THE_BENCH
    # where there is a cylinder, its own friction is searched and not the load's
    assert not ids & {"load.coulomb_friction", "load.viscous_friction", "load.offset_force"}


def test_an_effect_that_is_on_is_part_of_the_model_and_no_candidate(bench, recorded) -> None:
    on = bench.with_values({"effects.sensor.drift.rate_rad_per_min": 0.01})
    ids = {c.id for c in candidates_of(on, "joint", natural_scales(on, "joint", recorded(bench, bench)))}
    assert "sensor.drift" not in ids


def test_a_rig_states_its_own_range(bench, recorded) -> None:
    from dataclasses import replace

    path = bench.full_path("effects.command.delay.delay_s")
    entries = {**bench.entries, path: replace(bench.entries[path], range=(0.0, 0.5))}
    rig = replace(bench, entries=entries)
    found = candidates_of(rig, "joint", natural_scales(bench, "joint", recorded(bench, bench)))
    delay = next(c for c in found if c.id == "command.delay")
    assert (delay.free[0].lower, delay.free[0].upper) == (0.0, 0.5)


def test_starts_lie_in_the_ranges_and_reach_the_records(bench, recorded) -> None:
    for candidate in candidates_of(bench, "joint", natural_scales(bench, "joint", recorded(bench, bench))):
        parameters = ParameterSet(bench, candidate.free)
        for start in candidate.starts:
            unit = parameters.unit(start)
            assert parameters.values(unit) == pytest.approx(start)


@pytest.mark.parametrize("joint", ["left_j1", "left_j3"])
def test_a_payload_is_searched_up_to_what_an_arm_could_carry(joint) -> None:
    """Joint 1 turns about a vertical axis: there a payload has inertia and no weight."""
    rig = load_rig(f"hydrolek_{joint}")
    record = rig.records()[0]
    load = record["load"]
    scales = hydraulic_scales(
        record, 5e-5, lever=0.12, travel=1.0, duration=30.0, nearest=0.0, levers=(0.1, 0.12)
    )
    weight = abs(load["payload_gravity_cos"]) + abs(load["payload_gravity_sin"])
    assert scales.payload * load["payload_inertia"] <= SLOWED**2 * load["inertia"] * (1.0 + 1e-12)
    assert scales.payload * weight <= scales.load_force * (1.0 + 1e-12)
    payload = EFFECTS["load.payload"].search["mass_kg"]
    assert 50.0 < scales.range_of(payload)[1] < 500.0  # an arm lifts 150 kg (thesis)


@pytest.mark.parametrize("joint", ["left_j4", "right_j5"])  # a vane has no rod
def test_a_payload_must_spin_more_than_the_rod_is_wrong(joint, recorded) -> None:
    """Thesis (4.9): M_R l^2 in mid-travel, while the lever l changes over the movement."""
    rig = load_rig(f"hydrolek_{joint}")
    record = rig.records()[0]
    load, low, high = record["load"], -0.9, -0.5
    time = np.arange(0.0, 10.0, 0.01)
    signals = {f"{joint}.command": np.sign(np.sin(time)), f"{joint}.angle": np.linspace(low, high, time.size)}
    experiments = experiments_of(rig, Recording("moved", time, signals, Path("moved.csv")))
    scales = natural_scales(rig, joint, experiments)
    levers = [stroke_and_lever(at, record)[1] for at in np.linspace(low, high, 1001).tolist()]
    differs = record["cylinder"]["rod_mass"] * (max(levers) ** 2 - min(levers) ** 2)
    assert (differs > 0.0) == (joint == "right_j5")
    assert scales.rod_payload * load["payload_inertia"] == pytest.approx(differs, rel=0.01)

    [payload] = [c for c in candidates_of(rig, joint, scales) if c.id == "load.payload"]
    assert payload.says_something({payload.size_path: 1.01 * scales.rod_payload + 1e-3})
    assert payload.says_something({payload.size_path: 0.99 * scales.rod_payload}) == (joint == "left_j4")


@pytest.mark.parametrize("leak", ["valve.null_leakage", "cylinder.cross_port_leakage"])
def test_a_joint_that_creeps_for_hours_is_tight(leak, recorded) -> None:
    """Merritt (1967), ch. 5: even a new spool leaks more than a ten-thousandth of its full flow."""
    rig = load_rig("joint_bench")
    experiments = recorded(rig, rig)
    scales = natural_scales(rig, "joint", experiments)
    full_flow = scales.rod_speed * rig.value("cylinder.area_a")
    [effect] = [c for c in candidates_of(rig, "joint", scales) if c.id == leak]
    pressure = rig.value("supply.pressure") - rig.value("supply.tank_pressure")
    assert not effect.says_something({effect.size_path: 0.9e-4 * full_flow / pressure})
    assert effect.says_something({effect.size_path: 1.1e-4 * full_flow / pressure})


@pytest.mark.parametrize(
    ("effect", "makes_no_difference"),
    [
        ("valve.asymmetric_overlap", lambda rig, travel: 1e-3 * rig.value("valve.full_opening")),
        (
            "cylinder.coulomb_friction",
            lambda rig, travel: (
                1e-3 * rig.value("cylinder.area_a") * (12e6 - rig.value("supply.tank_pressure"))
            ),
        ),
        ("sensor.hysteresis", lambda rig, travel: travel / 4096),
        ("fluid.entrained_air", lambda rig, travel: 5e-3),
    ],
)
def test_what_makes_no_difference_in_practice_is_no_finding(effect, makes_no_difference) -> None:
    """A micrometre of a spool of a millimetre, a thousandth of the force, a bit of twelve, half a percent of air."""
    rig = load_rig("hopsan_link", {"supply.pressure": "12 MPa"})
    travel = 0.5
    scales = hydraulic_scales(rig.records()[0], 1e-4, 0.2, travel, 40.0, 0.0, (0.2, 0.2))
    [own] = [c for c in candidates_of(rig, "joint", scales) if c.id == effect]
    size = makes_no_difference(rig, travel)
    assert not own.says_something({own.size_path: 0.98 * size})
    assert own.says_something({own.size_path: 1.02 * size})


def test_every_effect_says_how_far_it_is_searched() -> None:
    scaled = {name for name, kind in vars(Scales).items() if isinstance(kind, property)}
    fields = {*Scales.__dataclass_fields__, *scaled}
    for effect in EFFECTS.values():
        read = {name.rpartition(".")[2] for name in effect.reads}
        assert set(effect.search) == {p.name for p in effect.parameters} - read, effect.id
        assert effect.beneath in {"", *fields}
        for search in effect.search.values():
            assert search.of in fields and search.beyond in {"", *fields}
            assert all(search.lowest <= start <= search.largest for start in search.starts)


def test_scales_follow_closed_forms(bench, recorded) -> None:
    scales = natural_scales(bench, "joint", recorded(bench, bench))
    # 0.7 * 0.67 mm^2 * sqrt(2 * 8 MPa / 870) through the fully opened valve at half of the supply
    flow = 0.7 * 0.67e-6 * math.sqrt(2.0 * 8e6 / 870.0)
    assert scales.conductance * 15.8e6 == pytest.approx(flow, rel=1e-3)
    assert scales.force == pytest.approx(800e-6 * 15.8e6, rel=1e-9)
    assert scales.resistance * scales.conductance == pytest.approx(1.0)


def test_a_cushion_is_searched_from_where_the_joint_came_nearest_to_its_end(bench, recorded) -> None:
    experiments = recorded(bench, bench, largest_V=4.0)
    scales = natural_scales(bench, "joint", experiments)
    records = bench.records()
    readings = experiments[0].simulate(records, 1e-3).signals.reading
    nearest = min(stroke_and_lever(angle, records[0])[0] for angle in readings.tolist())
    assert scales.nearest == pytest.approx(nearest, abs=5e-4)  # noise of 0.05 deg
    assert scales.nearest > 0.3 * scales.stroke  # lengths counted from the end would not be reached
    cushion = next(c for c in candidates_of(bench, "joint", scales) if c.id == "cylinder.end_cushion")
    lengths = [start[f"{cushion.path}.length_m"] for start in cushion.starts]
    assert scales.nearest < min(lengths) and max(lengths) < scales.nearest + 0.5 * scales.stroke
    lower, upper = next((f.lower, f.upper) for f in cushion.free if f.path.endswith("length_m"))
    assert lower < 0.02 * scales.stroke and upper == pytest.approx(scales.nearest + 0.5 * scales.stroke)


def test_numbers_that_only_frictions_read_are_searched_with_these_alone() -> None:
    """How a dry friction is smoothed and fades is no number of a machine without one."""
    rig = load_rig("hopsan_link")
    scales = hydraulic_scales(rig.records()[0], 1e-4, 0.2, 0.5, 40.0, 0.0, (0.2, 0.2))
    found = {c.id: c for c in candidates_of(rig, "joint", scales)}
    nominal = free_of_joints(rig, {"joint"})
    read = ("friction_velocity", "fading", "bristle")
    assert not [free.path for free in nominal if any(name in free.path for name in read)]

    def numbers(*ids: str) -> list[str]:
        with ThreadPoolExecutor(1) as pool:
            bench = Workbench(rig, nominal, (), pool, 1)
            added = bench.numbers([found[id_] for id_ in ids])[len(nominal) :]
        return [free.path.removeprefix("joints.joint.") for free in added]

    assert numbers("command.delay") == []
    assert numbers("cylinder.coulomb_friction") == [
        "cylinder.friction_velocity",
        "cylinder.bristle_deflection",
        "cylinder.bristle_time",
    ]
    assert numbers("load.coulomb_friction") == ["load.friction_velocity"]
    assert numbers("load.coulomb_friction", "load.stribeck_friction") == [
        "load.friction_velocity",
        "effects.load.stribeck_friction.fading_exponent",
    ]


def test_a_friction_that_is_on_has_its_numbers_in_the_nominal_model() -> None:
    rig = load_rig("hopsan_link").with_values({"effects.cylinder.coulomb_friction.coulomb_N": 100.0})
    paths = {free.path for free in free_of_joints(rig, {"joint"})}
    assert "joints.joint.cylinder.friction_velocity" in paths
    assert "joints.joint.load.friction_velocity" not in paths
