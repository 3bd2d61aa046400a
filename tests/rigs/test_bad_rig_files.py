"""Whatever is wrong with a rig file: one line that names file, key, value and choices."""

import copy

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import built_in_rigs, load_rig

BENCH = yaml.safe_load(built_in_rigs()["joint_bench"].read_text(encoding="utf-8"))
REMOVED = object()
DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def _changed(path, value):
    """The bench's tree with one place set, or removed."""
    tree = copy.deepcopy(BENCH)
    *parents, last = path.split("/")
    node = tree
    for key in parents:
        node = node.setdefault(key, {})
    if value is REMOVED:
        del node[last]
    else:
        node[last] = value
    return tree


def _refusal(tmp_path, text):
    path = tmp_path / "mine.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        load_rig(path)
    message = str(caught.value)
    assert "\n" not in message
    assert "mine.yaml" in message
    return message


@pytest.mark.parametrize(
    ("place", "value", "says"),
    [
        ("supply/presure", {}, ["supply.presure", "did you mean pressure?"]),
        ("suply", {}, ["'suply'", "supply, accumulator, fluid, joints"]),
        ("schema", 7, ["schema", "7", "1"]),
        ("supply/pressure/unit", "kg", ["supply.pressure", "'kg'", "Pa"]),
        ("supply/pressure/unit", "MegaPascalish", ["supply.pressure", "'MegaPascalish'", "Pa"]),
        ("supply/pressure/unit", REMOVED, ["supply.pressure", "'unit' is missing"]),
        ("supply/pressure/sorce", "x", ["supply.pressure", "'sorce'", "source"]),
        ("supply/pressure", REMOVED, ["supply.pressure is missing", "pump pressure", "[Pa]"]),
        ("supply/pressure", 16, ["supply.pressure", "'16'", "{value: ..., unit: Pa"]),
        ("supply", 16, ["supply must be a mapping"]),
        ("supply/pressure/value", -1, ["supply.pressure", "-1e+06 Pa is impossible", "between 0"]),
        ("supply/pressure/value", "much", ["supply.pressure", "'much' is not a number"]),
        ("supply/pressure/value", True, ["supply.pressure", "'True' is not a number"]),
        ("supply/pressure/value", [1], ["supply.pressure", "'[1]' is not a number"]),
        ("supply/pressure/value", float("nan"), ["supply.pressure", "NaN"]),
        ("supply/pressure/value", float("inf"), ["supply.pressure", "not a finite number"]),
        ("fluid/density/value", 0, ["fluid.density", "above zero"]),
        ("supply/pressure/range", [19, 13], ["supply.pressure", "[19, 13] is empty"]),
        ("supply/pressure/range", [13], ["supply.pressure", "'[13]' must be a list of two numbers"]),
        ("supply/pressure/range", [-1, 13], ["supply.pressure", "log scale needs a range above zero"]),
        ("supply/pressure/scale", "cubic", ["supply.pressure", "'cubic'", "linear or log"]),
        (
            "joints/joint/valve/variant",
            "rotary",
            ["joints.joint.valve.variant", "'rotary'", "plain, pressure_c"],
        ),
        ("joints/joint/valve/variant", REMOVED, ["joints.joint.valve.variant is missing", "plain"]),
        ("joints/joint/valve/overlap_b", {"same_as": "overlap"}, ["valve.overlap_b.same_as", "'overlap'"]),
        ("joints/joint/valve/overlap_a", {"same_as": "overlap_b"}, ["same_as", "circle"]),
        ("joints/joint/gearbox", {}, ["joints.joint.gearbox", "unknown stage", "sensor, effects"]),
        ("joints/joint/linkage/angle_offset/value", 170, ["linkage", "impossible triangle", "180"]),
        ("joints/joint/linkage/distance_child/value", 0, ["linkage.distance_child", "above zero"]),
        ("joints/joint/linkage/direction/value", 0.5, ["linkage.direction", "0.5", "1 or -1"]),
        (
            "joints/joint/linkage/zero_stroke_length/value",
            0.4,
            ["zero_stroke_length", "0.4 m is longer by 0.11"],
        ),
        ("joints/joint/load/upper_stop/value", -20, ["load", "lower_stop", "below upper_stop"]),
        ("joints/joint/sensor/travel_upper/value", -10.3, ["sensor", "travel_lower", "below travel_upper"]),
        ("joints/joint/valve/full_opening_a/value", 0.05, ["full_opening_a", "larger than overlap_a"]),
        ("joints/joint/effects", {"load.paylod": {}}, ["no effect 'load.paylod'", "load.payload"]),
        ("joints/joint/effects", {5: {}}, ["no effect '5'"]),
        ("joints/joint/effects", ["load.payload"], ["joints.joint.effects must be a mapping"]),
        ("effects", "load.payload", ["effects must be a mapping"]),
        (
            "joints/joint/effects",
            {"load.payload": {"mass": {}}},
            ["load.payload.mass", "did you mean mass_kg?"],
        ),
        ("joints/joint/effects", {"load.payload": 5}, ["load.payload must be a mapping"]),
        ("joints/joint", 3, ["joints.joint must be a mapping"]),
        ("joints/joint/like", "other", ["joints.joint.like", "'other'", "joint"]),
        ("joints/joint/like", "joint", ["joints.joint.like", "circle"]),
        ("joints/joint/like", [1], ["joints.joint.like", "'[1]'"]),
        ("joints", {}, ["'joints' is missing"]),
        ("keep", ["elbow"], ["keep", "'elbow'", "joint"]),
        ("keep", 5, ["keep", "must be a list of joints"]),
        ("keep", [], ["keep", "must be a list of joints"]),
        ("keep", [["joint"]], ["keep", "joint"]),
        ("recording/initial_position", "middle", ["initial_position", "'middle'", "rig or recording"]),
        ("recording/columns", ["a"], ["recording.columns", "mapping"]),
        ("integration", REMOVED, ["integration.longest_step is missing"]),
        ("integration/longest_step/value", 0, ["integration.longest_step", "impossible"]),
        ("based_on", "no_such_rig", ["no rig 'no_such_rig'", "joint_bench"]),
        ("based_on", "mine.yaml", ["based_on goes in a circle"]),
        ("based_on", 5, ["no rig '5'"]),
    ],
)
def test_a_wrong_rig_says_where_and_what_would_be_right(tmp_path, place, value, says):
    message = _refusal(tmp_path, yaml.safe_dump(_changed(place, value)))
    for part in says:
        assert part in message, message


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "empty or not a mapping"),
        ("- a\n- b\n", "empty or not a mapping"),
        ("supply: {pressure: [", "not valid YAML"),
        ("a: b: c", "not valid YAML"),
        (b"\x00\x01\x02\xff\xfe", "cannot be read"),
        (b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "cannot be read"),
        ("name: a\x01b", "not valid YAML"),
        ("!!python/object/apply:os.system ['true']", "not valid YAML"),
    ],
)
def test_a_file_that_is_no_rig_at_all(tmp_path, content, says):
    assert says in _refusal(tmp_path, content)


def test_two_files_based_on_each_other_are_refused(tmp_path):
    (tmp_path / "other.yaml").write_text("based_on: mine.yaml")
    assert "circle" in _refusal(tmp_path, "based_on: other.yaml")


def test_a_missing_file_and_an_unknown_name_are_refused(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        load_rig(tmp_path / "nothing.yaml")
    with pytest.raises(InputError, match=r"did you mean joint_bench\?.*built in are.*emps"):
        load_rig("joint_bensh")


def _places(node, prefix=()):
    for key, value in node.items():
        yield (*prefix, key)
        if isinstance(value, dict):
            yield from _places(value, (*prefix, key))


PLACES = sorted(_places(BENCH), key=str)
WRONG = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**320), 10**320),
    st.floats(),
    st.text(max_size=8),
    st.lists(st.integers(-3, 3), max_size=3),
    st.dictionaries(st.one_of(st.text(max_size=5), st.integers()), st.integers(), max_size=2),
    st.sampled_from(["none", "same", "joint", "deg", "MPa", "overlap_b", "1e999", "-1", "0"]),
    st.sampled_from(PLACES).map(lambda place: _at(BENCH, place)),  # a piece from elsewhere
)
MUTATIONS = st.lists(
    st.tuples(st.sampled_from(PLACES), st.sampled_from(["delete", "replace", "rename", "add"]), WRONG),
    min_size=1,
    max_size=3,
)


def _at(tree, place):
    for key in place:
        tree = tree[key]
    return tree


@settings(max_examples=300, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(MUTATIONS)
def test_random_damage_loads_or_is_refused_in_one_line(tmp_path, mutations):
    tree = copy.deepcopy(BENCH)
    for place, action, value in mutations:
        try:
            parent = _at(tree, place[:-1])
            old = parent[place[-1]]
        except (KeyError, TypeError, IndexError):
            continue  # an earlier mutation took it away
        if action == "delete":
            del parent[place[-1]]
        elif action == "replace":
            parent[place[-1]] = copy.deepcopy(value)
        elif action == "rename":
            parent[str(value)[:12]] = parent.pop(place[-1])
        elif isinstance(old, dict):
            old[str(value)[:12]] = copy.deepcopy(value)
    path = tmp_path / "damaged.yaml"
    path.write_text(yaml.dump(tree, Dumper=DUMPER), encoding="utf-8")
    try:
        rig = load_rig(path)
        rig.records()
        rig.as_tree()
    except InputError as refusal:
        assert "\n" not in str(refusal)
        assert str(refusal)
