"""YAML that means harm or was damaged: one line with file, line and column; never a traceback, a hang or a crash."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import hydrolek_drake
from hydrolek_drake.control.designed import read_model
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import built_in_rigs, load_rig
from hydrolek_drake.scenarios.scenario import load_scenario, scenario_files
from hydrolek_drake.units import si_factor
from hydrolek_drake.yaml_files import parse_yaml, read_yaml

DEEP = 100_000

LAUGHS = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 12)
)

ATTACKS = {
    "deep lists": ("[" * DEEP, "more than 32 mappings or lists in each other"),
    "deep mappings": ("{a: " * DEEP, "more than 32 mappings or lists in each other"),
    "deep blocks": ("- " * DEEP + "a", "more than 32 mappings or lists in each other"),
    "deep by aliases": (
        "a0: &a0 [1]\n" + "".join(f"a{n}: &a{n} [*a{n - 1}]\n" for n in range(1, 40)),
        "more than 32 mappings or lists in each other",
    ),
    "aliases that multiply values": (LAUGHS, "more than 100000 values"),
    "aliases that multiply text": (
        f"a: &a {'x' * 9000}\nb: [{', '.join(['*a'] * 400)}]",
        "more than 2000000 characters",
    ),
    "alias of itself": ("title: &t [*t]", "line 1, column 12: alias *t stands within what it stands for"),
    "alias of nothing": ("title: *t", "alias *t has no anchor"),
    "date that is none": ("title: !!timestamp 2026-13-45", "line 1, column 8: tag !!timestamp"),
    "float that is none": ("title: !!float x", "line 1, column 8: 'x' is not a number"),
    "integer that is none": ("title: !!int ''", "'' is not a whole number"),
    "boolean that is none": ("title: !!bool maybe", "'maybe' is not true or false"),
    "mapping that is none": ("title: !!map x", "tag !!map"),
    "list that is none": ("title: !!seq {a: 1}", "tag !!seq"),
    "bytes": ("title: !!binary x", "tag !!binary"),
    "set": ("title: !!set {a}", "tag !!set"),
    "object": ("title: !!python/object/apply:os.system [true]", "tag !!python/object"),
    "own tag": ("title: !mine x", "tag !mine is not read here"),
    "long integer": ("title: " + "9" * 5000, "a whole number of 5000 digits"),
    "large integer": ("title: 99999999999999999999", "write it as 1.0e+20"),
    "long base 60": ("title: !!int '1" + ":1" * 400 + "'", "a whole number of 401 digits"),
    "long text": ("title: " + "x" * 20_000, "a value of 20000 characters"),
    "key that is a list": ("? [a]\n: b", "a key must be text or a number"),
    "key that is a mapping": ("{a: 1}: b", "a key must be text or a number"),
    "key twice": ("title: a\nname: b\ntitle: c", "line 3, column 1: key 'title' stands in line 1 already"),
    "merge of text": ("<<: text", "'<<' takes a mapping"),
    "merge of a list of text": ("<<: [a, b]", "'<<' takes a mapping"),
    "NUL": ("title: a\x00b", "line 1, column 9: a character that text cannot hold"),
    "NUL by its code": ('title: "\\0"', r"line 1, column 8: text with the control character"),
    "colour of a terminal": ('title: "\\e[31m"', r"text with the control character"),
    "half a character": ('title: "\\ud800"', "line 1, column"),
    "not UTF-8": (b"title: a\nname: \xff\xfe", "line 2, column 7: byte 0xff is not UTF-8"),
    "UTF-16": ("title: a".encode("utf-16"), "line 1, column 1: byte 0xff is not UTF-8"),
    "tab": ("title:\n\tname: a", "indent with blanks"),
    "open bracket": ("title: [", "close the bracket"),
    "open quote": ("title: 'a", "close the quotes"),
    "colon in text": ("title: a: b", "quote text that holds ': '"),
    "two documents": ("title: a\n---\ntitle: b", "line 2, column 1: another document begins"),
    "other version": ("%YAML 9.9\n---\ntitle: a", "incompatible YAML document"),
    "large": ("# " + "x" * 2_100_000, "larger than 2 MB"),
}

READERS = {"rig": load_rig, "scenario": load_scenario, "design": read_model}


@pytest.mark.parametrize("reader", READERS.values(), ids=READERS.keys())
@pytest.mark.parametrize(("content", "says"), ATTACKS.values(), ids=ATTACKS.keys())
def test_one_line_with_file_line_and_column(tmp_path, reader, content, says):
    path = tmp_path / "mine.yaml"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(InputError) as caught:
        reader(path)
    message = str(caught.value)
    assert says in message
    assert "mine.yaml" in message
    assert message.isprintable() and len(message) < 600
    assert re.search(r"line \d+, column \d+", message) or "larger than" in message


@pytest.mark.parametrize("command", [["rigs"], ["simulate"], ["control", "design"]], ids=lambda c: c[0])
def test_deep_nesting_does_not_end_the_process(tmp_path, command):
    path = tmp_path / "mine.yaml"
    path.write_text("[" * DEEP + "]" * DEEP)
    done = subprocess.run(
        [sys.executable, "-c", "from hydrolek_drake.cli.app import main; main()", *command, str(path)],
        cwd=Path(hydrolek_drake.__file__).parent.parent,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "more than 32" in done.stderr and "Traceback" not in done.stderr


def test_what_yaml_is_good_for_is_read():
    text = """
    title: &who 'a, b'
    made: 2026-11-24
    time: 12:30:15
    yes: [yes, no, ~, .inf, 0x10, 1_000, 1.5e+3, '1', !!str 1, !!float 2]
    base: &base {a: 1, b: 2}
    more: {<<: [*base, {b: 3, c: 4}], a: 5}
    who: *who
    """
    assert parse_yaml(text, "here") == {
        "title": "a, b",
        "made": "2026-11-24",
        "time": 45015,
        True: [True, False, None, float("inf"), 16, 1000, 1500.0, "1", "1", 2.0],
        "base": {"a": 1, "b": 2},
        "more": {"b": 2, "c": 4, "a": 5},
        "who": "a, b",
    }


def test_an_alias_gives_a_copy():
    content = parse_yaml("a: &a {b: [1]}\nc: *a", "here")
    content["c"]["b"].append(2)
    assert content["a"] == {"b": [1]}


def test_a_mark_of_byte_order_is_passed_over(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1")
    assert read_yaml(path, "file") == {"a": 1}


def test_there_is_no_other_reader_of_yaml():
    package = Path(hydrolek_drake.__file__).parent
    reads = re.compile(r"\byaml\.(?:\w*load\w*|compose\w*|parse|scan)\(")
    found = [path.name for path in package.rglob("*.py") if reads.search(path.read_text(encoding="utf-8"))]
    assert found == ["yaml_files.py"]


@pytest.mark.parametrize(
    "unit",
    [
        "m^9^9^9",
        "9**9**9",
        "10**10**8*m",
        "m*" * 3000 + "m",
        "(" * 3000 + "m" + ")" * 3000,
        "m\x00",
        "m^99999",
        "degC",
        "dB",
        "0*m",
        "[m]",
        "m+m",
        "lambda: m",
        "__import__('os')",
        "",
        "nan*m",
    ],
)
def test_a_unit_is_no_expression(unit):
    with pytest.raises(InputError):
        si_factor(unit, "K" if unit == "degC" else "1" if unit == "dB" else "m")


def test_a_number_that_is_too_large_in_si_is_refused(tmp_path):
    path = tmp_path / "mine.yaml"
    text = built_in_rigs()["joint_bench"].read_text(encoding="utf-8")
    for old, new in (("value: 16, unit: MPa", "value: 1.0e+305, unit: MPa"), ("18.08]", "1.0e+305]")):
        path.write_text(text.replace(old, new))
        with pytest.raises(InputError, match=r"supply\.pressure.*too large a number in SI"):
            load_rig(path)


def test_a_rig_of_a_thousand_joints_is_refused(tmp_path):
    path = tmp_path / "mine.yaml"
    joints = ["  j0: {}", *(f"  j{n}: {{like: j{n - 1}}}" for n in range(1, 3000))]
    path.write_text("schema: 1\njoints:\n" + "\n".join(joints))
    with pytest.raises(InputError, match="3000 joints; a rig has at most 64"):
        load_rig(path)


def test_a_hundred_files_based_on_each_other_are_refused(tmp_path):
    for n in range(100):
        (tmp_path / f"{n}.yaml").write_text(f"schema: 1\nbased_on: {n + 1}.yaml\n")
    with pytest.raises(InputError, match="more than 16 files"):
        load_rig(tmp_path / "0.yaml")


STEP = scenario_files()["step_one_joint"].read_text(encoding="utf-8")
RANDOM = scenario_files()["random_one_joint"].read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (STEP.replace("duration: 8 s", "duration: 1.0e+300"), "2000000 rows"),
        (RANDOM.replace("levels: ", "levels: 9223372036854775807 #"), "levels"),
        (RANDOM.replace("duration: ", "duration: 1.0e+12 #"), "2000000 rows"),
        (RANDOM + "integration: {log_period: 1.0e-9}\n", "2000000 rows"),
        (RANDOM + "integration: {step: 1.0e-300}\n", "step"),
    ],
)
def test_a_scenario_that_would_never_end_is_refused(tmp_path, text, says):
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=says):
        load_scenario(path)


def test_a_message_is_one_printable_line_whatever_it_quotes():
    message = str(InputError("a\nb\x1b[2J\ud800 " + "x" * 10_000))
    assert message.startswith(r"a b\x1b[2J\ud800 xx") and message.isprintable() and len(message) <= 1500
