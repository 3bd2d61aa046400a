"""Slips in a rig that is loaded without a word: they are told, with the line that mends them."""

import io

import pytest
from rich.console import Console

from hydrolek_drake.checking.rig_checks import check_rig
from hydrolek_drake.cli.inputs import tell_what_looks_wrong
from hydrolek_drake.rigs import built_in_rigs, load_rig


@pytest.mark.parametrize("name", [name for name in built_in_rigs() if name != "hydrolek"])
def test_built_in_rigs_are_left_alone(name):
    assert [c.sentence() for c in check_rig(load_rig(name)) if c.wrong] == []


@pytest.mark.parametrize(
    ("path", "text", "says"),
    [
        ("cylinder.stroke", "300 m", "stroke: {value: 0.3, unit: m"),
        ("cylinder.area_b", "876 m^2", "is the unit right?"),
        ("fluid.bulk_modulus", "1 MPa", "bulk_modulus: {value: 1e+09, unit: Pa"),
        ("fluid.density", "0.87 kg/m^3", "density: {value: 870, unit: kg/m^3"),
        ("supply.pressure", "120 Pa", "is the unit right?"),
        ("command.delay", "15 s", "delay: {value: 0.015, unit: s"),
        ("solenoid.full_stroke", "1 m", "full_stroke: {value: 0.001, unit: m"),
        ("load.mass", "20 mg", "is the unit right?"),
        ("command.limit", "10 kV", "limit: {value: 10, unit: V"),
        ("supply.line_volume", "1000 m^3", "line_volume: {value: 1, unit: m^3"),
        ("integration.longest_step", "20 ms", "too long for this machine"),
        ("cylinder.stroke", "50 mm", "the cylinder has 0.05 m"),
    ],
)
def test_a_slip_is_told_with_the_line_that_mends_it(path, text, says):
    rig = load_rig("hopsan_link", {path: text})
    told = [complaint.sentence() for complaint in check_rig(rig) if complaint.wrong]
    assert any(path.split(".")[-1] in said or path.split(".")[0] in said for said in told)
    assert any(says in said for said in told)


def test_a_displacement_per_turn_that_stands_per_radian_is_asked_about():
    rig = load_rig("hopsan_link", {"supply.displacement": "3e-5 m^3/rad"})
    [told] = check_rig(rig)
    assert "meant per turn" in told.says and "cm^3/rev" in told.line and not told.wrong


def test_a_value_outside_its_range_is_told_since_a_fit_begins_at_the_end_of_it():
    rig = load_rig("hopsan_link", {"load.mass": "500 kg"})
    [told] = [complaint for complaint in check_rig(rig) if complaint.about.endswith("load.mass")]
    assert "500 lies outside its range" in told.says and "500]" in told.line


@pytest.mark.parametrize("value", [250, 800, 1200])
def test_a_stop_of_a_slide_in_mm_that_stands_in_m_is_told_however_long_the_slide(value):
    told = [
        c for c in check_rig(load_rig("emps", {"load.upper_stop": f"{value} m"})) if "upper_stop" in c.about
    ]
    assert any("is the unit right?" in each.says for each in told)


def test_a_value_that_a_fit_left_at_the_end_of_its_range_lies_in_it():
    _, highest = load_rig("hopsan_link").entries["joints.joint.load.mass"].range
    rig = load_rig("hopsan_link", {"load.mass": f"{highest * (1.0 + 1e-12)!r} kg"})
    assert [c for c in check_rig(rig) if c.about.endswith("load.mass")] == []


@pytest.mark.parametrize("name", built_in_rigs())
def test_nothing_is_said_of_a_built_in_rig_before_a_command(name):
    console = Console(file=io.StringIO())
    tell_what_looks_wrong(load_rig(name), [], console)
    assert console.file.getvalue() == ""


@pytest.mark.parametrize(
    ("text", "says"),
    [("500 kg", "outside its range of"), ("50000000 kg", "far from what machines have")],
)
def test_what_looks_wrong_about_a_rig_is_said_before_a_fit_begins(text, says):
    console = Console(file=io.StringIO(), width=400)
    tell_what_looks_wrong(load_rig("hopsan_link", {"load.mass": text}), [], console)
    told = console.file.getvalue()
    assert told.startswith("looks wrong: rig hopsan_link: joints.joint.load.mass")
    assert says in told and told.count("\n") == 1
