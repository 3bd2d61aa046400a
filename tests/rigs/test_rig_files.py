"""Built-in rigs: complete, sourced, and unchanged by writing and reading."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.records import flat
from hydrolek_drake.rigs import built_in_rigs, load_rig
from hydrolek_drake.rigs.parameters.arm_loads import FROM_ARM

BUILT_IN = sorted(built_in_rigs())
PLACEHOLDERS = ("-", "?", "todo", "tbd", "none", "unknown")


def test_the_rigs_that_the_contract_promises_for_single_joints_are_built_in():
    assert {"joint_bench", "emps"} <= set(BUILT_IN)


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_parameter_has_a_source_a_unit_and_a_sane_range(name):
    rig = load_rig(name)
    assert rig.name == name and rig.title and rig.joints
    for path, entry in rig.entries.items():
        if entry.same_as is None:
            assert entry.unit, path
            assert len(entry.source) >= 5 and entry.source.lower() not in PLACEHOLDERS, path
        assert np.isfinite(rig.value(path)), path
        if entry.range is not None:
            assert entry.range[0] <= rig.value(path) <= entry.range[1], path


@pytest.mark.parametrize("name", BUILT_IN)
def test_a_rig_written_and_read_again_is_the_same(name, tmp_path):
    rig = load_rig(name)
    changed = rig.with_values({path: entry.value for path, entry in list(rig.free_parameters().items())[:1]})
    file = tmp_path / "again.yaml"
    file.write_text(yaml.safe_dump(changed.as_tree(), sort_keys=False))  # the order of joints counts
    again = load_rig(file)
    np.testing.assert_array_equal(flat(again.records()), flat(rig.records()))
    assert again.free_parameters().keys() == rig.free_parameters().keys()
    assert again.variants == rig.variants
    assert again.columns == rig.columns and again.initial_position == rig.initial_position


def test_a_fitted_rig_with_effects_written_and_read_again_is_the_same(tmp_path):
    rig = load_rig("joint_bench").with_values(
        {
            "supply.pressure": 15.3e6,
            "effects.cylinder.coulomb_friction.coulomb_N": 905.0,
            "effects.fluid.warm_up.fraction": 0.2,
            "effects.fluid.warm_up.time_constant_s": 31.0,
        }
    )
    file = tmp_path / "fitted.yaml"
    file.write_text(yaml.safe_dump(rig.as_tree()))
    again = load_rig(file)
    np.testing.assert_array_equal(flat(again.records()), flat(rig.records()))
    assert again.effects_on("joint") == rig.effects_on("joint") != ()
    assert again.value("valve.overlap_b") == again.value("valve.overlap_a")


def test_si_values_of_the_bench_are_the_page_s():
    rig = load_rig("joint_bench")
    for path, value in {
        "supply.pressure": 16e6,
        "valve.overlap_b": 0.06e-3,
        "valve.max_area_a": 0.67e-6,
        "cylinder.dead_volume_b": 40e-6,
        "linkage.angle_offset": np.pi / 3,
        "load.lower_stop": np.radians(-10.3),
        "fluid.bulk_modulus": 1e9,
        "command.delay": 0.02,
    }.items():
        assert rig.value(path) == pytest.approx(value, rel=1e-12)


def test_settings_take_units_or_si_and_leave_the_original_alone():
    rig = load_rig("joint_bench")
    changed = load_rig(
        "joint_bench",
        {
            "supply.pressure": "12 MPa",
            "load.inertia": "27.5",
            "joints.joint.load.initial_position": "10 deg",
            "valve.overlap_b": "0.07 mm",
            "effects.command.delay.delay_s": "90 ms",
        },
    )
    assert changed.value("supply.pressure") == pytest.approx(12e6)
    assert changed.value("load.inertia") == 27.5
    assert changed.value("load.initial_position") == pytest.approx(np.radians(10))
    assert changed.value("valve.overlap_b") == pytest.approx(0.07e-3)
    assert changed.value("valve.overlap_a") == pytest.approx(0.06e-3)  # no longer followed by b
    assert changed.value("effects.command.delay.delay_s") == pytest.approx(0.09)
    assert rig.value("supply.pressure") == 16e6


@pytest.mark.parametrize(
    ("rig", "path", "text", "value"),
    [
        ("emps", "linkage.backlash.gap_rad", "5 mm", 5e-3),  # where the load slides an angle is a length
        ("emps", "linkage.backlash.gap_rad", "0.005 rad", 5e-3),  # as files of older versions say it
        ("emps", "sensor.drift.rate_rad_per_min", "1 mm/min", 1e-3),
        ("emps", "base.compliance.stiffness_Nm_per_rad", "2 kN/m", 2e3),
        ("joint_bench", "linkage.backlash.gap_rad", "1 deg", np.radians(1)),
        ("hopsan_link", "load.coulomb_friction.force_N", "40 N m", 40.0),
        ("hydrolek_left_j4", "cylinder.coulomb_friction.coulomb_N", "3 N m", 3.0),
    ],
)
def test_an_effect_is_stated_in_the_unit_that_it_has_at_its_joint(rig, path, text, value):
    loaded = load_rig(rig)
    full = f"joints.{loaded.joints[0]}.effects.{path}"
    assert load_rig(rig, {full: text}).value(full) == pytest.approx(value)


def test_an_effect_of_a_slide_is_written_with_the_unit_of_a_slide(tmp_path):
    path = "joints.axis.effects.linkage.backlash.gap_rad"
    tree = load_rig("emps", {path: "5 mm"}).as_tree()
    assert tree["joints"]["axis"]["effects"]["linkage.backlash"]["gap_rad"]["unit"] == "m"
    file = tmp_path / "worn.yaml"
    file.write_text(yaml.safe_dump(tree))
    assert load_rig(file).value(path) == pytest.approx(5e-3)


@pytest.mark.parametrize(
    ("path", "text", "match"),
    [
        ("effects.linkage.backlash.gap_rad", "5 mm", "does not say of which angle; use deg or rad"),
        ("supply.presure", "1 MPa", "no parameter 'supply.presure'; nearest: supply.pressure"),
        ("supply.pressure", "12 kg", "'kg' does not measure.*use Pa"),
        ("supply.pressure", "twelve", "'twelve' is not a number with a unit"),
        ("supply.pressure", "-3 MPa", "impossible"),
        ("supply.pressure", "nan", "NaN"),
        ("supply.pressure", "inf", "not a finite number"),
        ("load.inertia", "0", "above zero"),
        ("linkage.angle_offset", "175 deg", "impossible triangle"),
        ("linkage.direction", "0", "use 1 or -1"),
    ],
)
def test_a_wrong_setting_is_refused_in_one_line(path, text, match):
    with pytest.raises(InputError, match=match) as caught:
        load_rig("joint_bench", {path: text})
    assert "\n" not in str(caught.value)


def _write(folder: Path, name: str, tree: dict) -> Path:
    path = folder / name
    path.write_text(yaml.safe_dump(tree))
    return path


def test_a_rig_based_on_another_changes_what_it_names_and_keeps_the_rest(tmp_path):
    file = _write(
        tmp_path,
        "mine.yaml",
        {
            "based_on": "joint_bench",
            "supply": {"pressure": {"value": 14, "unit": "MPa", "source": "gauge"}},
            "effects": {"command.delay": {"delay_s": {"value": 20, "unit": "ms", "source": "scope"}}},
        },
    )
    rig, base = load_rig(file), load_rig("joint_bench")
    assert rig.value("supply.pressure") == 14e6
    assert rig.entries["supply.pressure"].range == base.entries["supply.pressure"].range  # same unit: kept
    assert rig.value("load.inertia") == base.value("load.inertia")
    assert rig.effects_on("joint") == ("command.delay",)
    second = _write(tmp_path, "second.yaml", {"based_on": "mine.yaml", "title": "second"})
    assert load_rig(second).value("supply.pressure") == 14e6


def test_another_unit_drops_the_range_that_was_in_the_old_one(tmp_path):
    entry = {"value": 140, "unit": "bar", "source": "gauge"}
    file = _write(tmp_path, "mine.yaml", {"based_on": "joint_bench", "supply": {"pressure": entry}})
    rig = load_rig(file)
    assert rig.value("supply.pressure") == pytest.approx(14e6)
    assert rig.entries["supply.pressure"].range is None


def test_like_copies_a_joint_and_keep_leaves_the_others_out(tmp_path):
    start = {"initial_position": {"value": 5, "unit": "deg", "source": "seen"}}
    two = {"based_on": "joint_bench", "joints": {"second": {"like": "joint", "load": start}}}
    rig = load_rig(_write(tmp_path, "two.yaml", two))
    assert rig.joints == ("joint", "second")
    assert rig.value("joints.second.load.initial_position") == pytest.approx(np.radians(5))
    assert rig.value("joints.second.load.inertia") == rig.value("joints.joint.load.inertia")
    assert len(rig.records()) == 2
    one = load_rig(_write(tmp_path, "one.yaml", {"based_on": "two.yaml", "keep": ["second"]}))
    assert one.joints == ("second",)
    assert one.value("load.initial_position") == pytest.approx(np.radians(5))
    assert one.held == {"joint": pytest.approx(np.radians(25))}
    again = load_rig(_write(tmp_path, "again.yaml", one.as_tree()))
    assert again.joints == one.joints and again.held == one.held
    np.testing.assert_array_equal(flat(again.records()), flat(one.records()))


def test_an_effect_switched_off_stays_off_in_the_written_rig(tmp_path):
    rig = load_rig("emps_published")
    off = {f"effects.load.{name}.force_N": 0.0 for name in ("coulomb_friction", "offset_force")}
    assert rig.effects_on("axis") == ("load.coulomb_friction", "load.offset_force")
    again = load_rig(_write(tmp_path, "off.yaml", rig.with_values(off).as_tree()))
    assert again.effects_on("axis") == ()


def test_loads_that_follow_from_the_arms_are_not_frozen_into_the_written_rig(tmp_path):
    arm = {
        "based_on": "joint_bench",
        "joints": {
            "right_j2": {"like": "joint", "load": {**_arm_load(), "variant": "arm"}},
        },
        "keep": ["right_j2"],
    }
    rig = load_rig(_write(tmp_path, "arm.yaml", arm))
    assert rig.entries["joints.right_j2.load.inertia"].unit == "kg m^2"
    tree = rig.as_tree()
    assert "inertia" not in tree["joints"]["right_j2"]["load"]
    again = load_rig(_write(tmp_path, "again.yaml", tree))
    assert again.entries.keys() == rig.entries.keys()
    known = load_rig(_write(tmp_path, "known.yaml", rig.with_values({"load.inertia": 21.0}).as_tree()))
    assert known.value("load.inertia") == 21.0


def _arm_load():
    """The bench's load without what an arm's geometry gives."""
    load = load_rig("joint_bench").tree["joints"]["joint"]["load"]
    return {key: value for key, value in load.items() if key not in FROM_ARM}
