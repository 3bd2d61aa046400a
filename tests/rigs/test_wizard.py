"""A rig from a data sheet: it loads, its numbers follow from the sheet's, and bad answers are refused in one line."""

import json
import shlex
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from sheets import LINK, SLIDE

from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import built_in_rigs, load_rig
from hydrolek_drake.rigs.reading.json_schema import rig_schema
from hydrolek_drake.rigs.reading.tree import rig_from_tree
from hydrolek_drake.wizard import questions, read_answers
from hydrolek_drake.wizard.making import text_of, written_rig
from hydrolek_drake.wizard.sheet import Sheet
from hydrolek_drake.yaml_files import parse_yaml, read_yaml

SCREW = {
    "moves": "screw", "travel": "160 mm", "lead": "5 mm", "torque_constant": "1.5 N m/A", "peak_current": "5 A",
    "mass": "5 kg",
}  # fmt: skip


@pytest.fixture(scope="module")
def link():
    """A turning link from its shortest data sheet."""
    return written_rig("link", LINK)[1]


def test_the_numbers_of_a_link_follow_from_its_sheet(link):
    assert np.isclose(link.value("cylinder.area_a"), np.pi * 0.02**2, rtol=1e-4)
    assert np.isclose(link.value("cylinder.area_b"), np.pi * (0.02**2 - 0.011**2), rtol=1e-4)
    assert np.isclose(link.value("linkage.distance_parent"), np.hypot(0.1, 0.3), rtol=1e-4)
    assert np.isclose(link.value("valve.area_gradient_at"), 0.8 * np.pi * 6e-3, rtol=1e-4)
    assert np.isclose(link.value("supply.displacement"), 30e-6 / (2 * np.pi), rtol=1e-4)
    a, b = link.value("linkage.distance_parent"), link.value("linkage.distance_child")
    included = 0.1 + link.value("linkage.angle_offset")  # half of the stroke
    length = np.sqrt(a * a + b * b - 2 * a * b * np.cos(included))
    assert np.isclose(length - link.value("linkage.zero_stroke_length"), 0.1, atol=1e-4)
    assert link.value("load.lower_stop") < 0.1 < link.value("load.upper_stop")


def test_what_nobody_said_is_assumed_and_wide(link):
    for path in (
        "fluid.bulk_modulus",
        "supply.tank_pressure",
        "joints.joint.cylinder.dead_volume_a",
        "joints.joint.load.damping",
    ):
        entry = link.entries[path]
        assert entry.source.startswith("assumed")
        assert entry.range is not None and entry.range[1] / entry.range[0] >= 4.0
    said = link.entries["joints.joint.load.mass"]
    assert (
        said.source == "data sheet" and said.range is not None and 4.0 < said.range[1] / said.range[0] < 5.0
    )  # a factor of two lies inside


def test_what_a_longer_sheet_of_the_same_link_says_lies_in_the_ranges_of_the_shorter_one(link):
    longer = load_rig("hopsan_link", {})
    told = [p for p, e in longer.entries.items() if e.source.startswith("data sheet") and "noise" not in p]
    assert len(told) > 20
    told.remove("supply.speed")  # only the flow counts, and that of the shorter sheet may be so much
    flow = longer.value("supply.displacement") * longer.value("supply.speed")
    assert flow <= link.entries["supply.displacement"].range[1] * link.value("supply.speed")
    for path in told:
        said, assumed = longer.entries[path].value, link.entries[path]
        low, high = assumed.range or (assumed.value, assumed.value)
        assert low * (1.0 - 1e-3) <= said <= high * (1.0 + 1e-3), path


def test_a_slide_with_a_rated_flow_gives_that_flow():
    rig = written_rig("axis", SLIDE)[1]
    opening = rig.value("valve.full_opening") - rig.value("valve.overlap_pa")
    area = rig.value("valve.area_gradient_pa") * opening
    flow = rig.value("valve.discharge") * area * np.sqrt(2 * 5e5 / 870)
    assert np.isclose(flow, 24e-3 / 60, rtol=1e-3)
    assert rig.variants["supply"] == "constant_pressure"


def test_a_screw_s_speed_loop_has_its_bandwidth_and_its_friction_the_drag_torque():
    told = {
        "position_gain": "4 1/s",
        "speed_bandwidth": "10 Hz",
        "drag_torque": "0.6 N m",
        "rotor_inertia": "2 kg cm^2",
    }
    rig = written_rig("axis", {**SCREW, **told, "pushed_by": "-196 N", "current_reads": "size"})[1]
    turn = 2 * np.pi / 5e-3
    moved = 5.0 + 2e-4 * turn**2
    loop = rig.value("cylinder.speed_gain") * 0.9 * 1.5 * turn / moved
    assert np.isclose(loop, 2 * np.pi * 10, rtol=1e-4)
    assert np.isclose(rig.value("cylinder.position_gain"), 4.0)
    friction = "effects.load.stribeck_friction"
    assert np.isclose(rig.value(f"{friction}.force_N"), 0.6 * turn, rtol=1e-4)
    assert rig.value("load.gravity_cos") == -196.0 and rig.value("sensor.current_size") == 1.0
    assert not rig.is_hydraulic("joint")
    torque = rig.entries["joints.joint.cylinder.torque_constant"]
    assert torque.range is not None and torque.range[1] / torque.range[0] > 4.0  # a factor of two lies inside


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"bore": "40 mm"}, "--bore: not of a machine with --moves screw"),
        ({"efficiency": "1.2"}, "more than 1"),
        ({"lead": "0 mm"}, "above zero"),
        ({"position_gain": "4 1/m"}, "--position-gain"),
        ({"position_gain": "4 5 1/s"}, "2 numbers, where 1 belong"),
    ],
)
def test_a_bad_answer_about_a_screw_is_refused_in_one_line(change, says):
    with pytest.raises(InputError) as caught:
        written_rig("axis", {**SCREW, **change})
    assert says in str(caught.value) and "\n" not in str(caught.value)


def test_what_is_missing_of_a_screw_is_listed():
    with pytest.raises(
        InputError, match=r"not answered: --mass .*--travel .*--lead .*--torque-constant .*--peak"
    ):
        written_rig("axis", {"moves": "screw"})


def test_the_built_in_link_is_what_the_wizard_writes_from_its_data_sheet():
    """By the command of docs/guides/own_machine.md, but for the step, which agrees on this machine's recordings."""
    guide = (Path(__file__).parents[2] / "docs" / "guides" / "own_machine.md").read_text()
    command = guide.split("$ hydrolek rig new hopsan_link.yaml ")[1].split("```")[0].replace("\\\n", " ")
    words = shlex.split(command)
    given = {key[2:].replace("-", "_"): value for key, value in zip(words[::2], words[1::2], strict=True)}
    text, _ = written_rig("hopsan_link", given)

    def lines(of: str) -> list[str]:
        return [line for line in of.splitlines() if "longest_step" not in line]

    assert lines(built_in_rigs()["hopsan_link"].read_text()) == lines(text)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"bore": "40 kg"}, "--bore '40 kg'"),
        ({"bore": "wide"}, "not a number with a unit"),
        ({"bore": "-40"}, "below zero"),
        ({"rod": "50"}, "not thinner than --bore"),
        ({"moves": "wheel"}, "choose link or slide or screw"),
        ({"base_mount": "0.1"}, "1 numbers, where 2 belong"),
        ({"stroke": "3 m"}, "a cylinder cannot reach"),
        ({"boar": "40"}, "did you mean --bore"),
        ({"mass": ""}, "--mass ''"),
        ({"mass": "1e999"}, "--mass"),
        ({"overlap": "1 mm"}, "no edge would open"),
    ],
)
def test_a_bad_answer_is_refused_in_one_line(change, says):
    with pytest.raises(InputError) as caught:
        written_rig("link", {**LINK, **change})
    assert says in str(caught.value) and "\n" not in str(caught.value)


def test_what_is_missing_is_listed_with_its_options():
    with pytest.raises(InputError, match=r"not answered: --bore .*--mass"):
        written_rig("link", {"moves": "link"})


def test_an_answer_may_be_a_share():
    assert read_answers({"overlap": "5 %"})["overlap"] == pytest.approx(0.05)
    rig = written_rig("link", {**LINK, "overlap": "5 %", "spool_travel": "2 mm"})[1]
    assert np.isclose(rig.value("valve.overlap_pa"), 0.1e-3)


def test_the_command_writes_once_and_says_so(tmp_path, capsys):
    path = tmp_path / "mine.yaml"
    arguments = [part for key, text in LINK.items() for part in (f"--{key.replace('_', '-')}", text)]
    assert run(["rig", "new", str(path), *arguments]) == 0
    assert load_rig(path).name == "mine"
    assert run(["rig", "new", str(path), *arguments]) == 2
    assert "is there already" in capsys.readouterr().err
    assert run(["rig", "check", str(path)]) == 0
    assert "nothing looks wrong" in capsys.readouterr().out


def test_the_file_may_be_an_option_or_stand_behind_the_answers(tmp_path, capsys):
    arguments = [part for key, text in SLIDE.items() for part in (f"--{key.replace('_', '-')}", text)]
    assert run(["rig", "new", *arguments, "--out", str(tmp_path / "a.yaml"), "--seed", "1"]) == 0
    assert run(["rig", "new", *arguments, str(tmp_path / "b.yaml")]) == 0
    first, second = (
        (tmp_path / name).read_text().replace("name: b", "name: a") for name in ("a.yaml", "b.yaml")
    )
    assert first.count("\n") == second.count("\n")
    assert run(["rig", "new", str(tmp_path / "no" / "c.yaml"), *arguments]) == 2
    assert "there is no folder" in capsys.readouterr().err
    assert run(["rig", "new", "a.yaml", "b.yaml", *arguments]) == 2
    assert "one FILE is written" in capsys.readouterr().err


def test_answers_that_are_not_of_the_machine_are_refused(tmp_path):
    for change in ({"lead": "5 mm"}, {"line_volume": "1 l"}, {"holding_ratio": "4"}):
        with pytest.raises(InputError, match="not of a machine with --moves slide"):
            written_rig("slide", SLIDE | change)


def test_every_question_is_listed(tmp_path, capsys):
    assert run(["rig", "new", "--questions"]) == 0
    listed = capsys.readouterr().out
    assert all(question.option in listed for question in questions().values())


@pytest.mark.parametrize("name", built_in_rigs())
def test_the_schema_takes_every_built_in_rig(name):
    jsonschema.Draft202012Validator(rig_schema()).validate(read_yaml(built_in_rigs()[name], "rig file"))


def test_the_schema_tells_a_wrong_key(capsys):
    assert run(["rig", "schema"]) == 0
    validator = jsonschema.Draft202012Validator(json.loads(capsys.readouterr().out))
    assert not validator.is_valid({"schema": 1, "supply": {"presure": {}}})
    assert not validator.is_valid({"supply": {"variant": "pump", "flow_time_constant": {"same_as": "x"}}})


STRANGE = (
    "0", "-1", "1e308", "1e-308", "nan", "inf", "", "0 0", "1,2", "1;2 m", "5 %", "-5 %", "1e5 %", "mm", "40 mm mm",
    "40 m^9^9", "40 degC", "1e30", "0x10", "link", "pump", "yes", "\x00", "'", "a" * 3000, "[1]", "0 0 0 0", "3.2 rad",
)  # fmt: skip


def test_strange_answers_give_a_rig_or_one_printable_line():
    generator, done = np.random.default_rng(5), {True: 0, False: 0}
    for _ in range(1000):
        given = dict((LINK, SLIDE, SCREW)[generator.choice(3, p=(0.5, 0.3, 0.2))])
        asked = [key for key, question in questions().items() if question.applies(given)]
        for key in generator.choice(asked, size=generator.integers(1, 3)):
            given[str(key)] = STRANGE[generator.integers(len(STRANGE))]
        try:
            text = text_of("strange", Sheet(read_answers(given)), 5e-4)
            rig_from_tree(parse_yaml(text, "strange"), Path("strange.yaml"))
            done[True] += 1
        except InputError as error:
            assert str(error).isprintable()
            done[False] += 1
    assert min(done.values()) > 20


def test_a_fit_may_move_the_load_s_stops_behind_those_of_the_cylinder():
    """A diagnosis that ended with a small dead volume and a late zero stroke could not write its rig."""
    _, rig = written_rig("link", LINK)
    zero, stroke = rig.value("linkage.zero_stroke_length"), rig.value("cylinder.stroke")
    moved = {
        "linkage.zero_stroke_length": zero + 0.02 * stroke,
        "cylinder.dead_volume_a": 0.3 * rig.value("cylinder.dead_volume_a"),
    }
    assert rig.with_values(moved).value("linkage.zero_stroke_length") > zero
    with pytest.raises(InputError, match="lies beyond zero stroke"):
        rig.with_values({**moved, "cylinder.stop_stiffness": 0.0})


def test_an_accumulator_hoses_and_a_holding_valve_follow_from_the_sheet():
    text, rig = written_rig(
        "crane",
        LINK | {
            "accumulator_volume": "2.5 l", "accumulator_precharge": "90 bar", "hose_length": "4 m",
            "hose_bore": "12 mm",
            "holding": "counterbalance", "holding_setting": "210 bar", "holding_ratio": "4.5", "holding_at": "both",
            "slew_time": "40 ms",
        },
    )  # fmt: skip
    assert rig.value("accumulator.volume") == pytest.approx(2.5e-3)
    assert rig.value("accumulator.precharge") == pytest.approx(9e6)
    assert rig.value("hose.resistance_b") == pytest.approx(
        128 * 46e-6 * 870 * 4 / (np.pi * 0.012**4), rel=1e-3
    )
    assert rig.value("hose.expansion_a") == pytest.approx(np.pi / 4 * 0.012**2 * 4 / 0.7e9, rel=1e-3)
    assert (rig.value("holding.setting"), rig.value("holding.pilot_ratio")) == pytest.approx((21e6, 4.5))
    assert (rig.value("holding.at_a"), rig.value("holding.at_b")) == (1.0, 1.0)
    assert rig.value("solenoid.slew_rate") == pytest.approx(1e-3 / 40e-3)
    assert "assumed: between slow (1) and fast changes" in text


def test_a_pilot_check_valve_is_at_port_a_unless_something_else_is_said():
    rig = written_rig("axis", SLIDE | {"holding": "pilot_check"})[1]
    assert rig.variant("joint", "holding") == "pilot_check"
    assert (rig.value("holding.at_a"), rig.value("holding.at_b")) == (1.0, 0.0)
    assert rig.entries["joints.joint.holding.pilot_ratio"].source.startswith("assumed")


@pytest.mark.parametrize(
    ("sheet", "change", "says"),
    [
        (SLIDE, {"accumulator_volume": "1 l"}, "not of a machine with --moves slide --supply constant"),
        (LINK, {"hose_length": "3 m"}, "give --hose-bore too"),
        (LINK, {"hose_bore": "12 mm"}, "give --hose-length too"),
        (LINK, {"holding": "check"}, "choose none or counterbalance or pilot_check"),
    ],
)
def test_half_a_component_is_refused(sheet, change, says):
    with pytest.raises(InputError, match=says):
        written_rig("axis", sheet | change)


def test_a_rig_without_a_file_to_write_it_to_is_refused(capsys):
    assert run(["rig", "new"]) == 2
    assert "no FILE to write" in capsys.readouterr().err
