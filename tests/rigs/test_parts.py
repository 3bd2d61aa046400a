"""Rigs made of parts: what a part states, what the rig states over it, and whose source counts."""

import pytest
import yaml

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import built_in_rigs, load_rig
from hydrolek_drake.yaml_files import read_yaml


@pytest.fixture
def rig(tmp_path):
    """A function: changes the link's tree, writes it and the parts given, and loads it."""

    def make(change=lambda tree: None, **parts):
        tree = read_yaml(built_in_rigs()["hopsan_link"], "rig file")
        valve = tree["joints"]["joint"]["valve"]
        tree["joints"]["joint"]["valve"] = {"uses": "valve.yaml"}
        part = {key: _without_source(value) for key, value in valve.items()}
        files = {"valve": {"source": "sheet of the valve", **part}, **parts}
        change(tree)
        for name, content in {**files, "rig": tree}.items():
            (tmp_path / f"{name}.yaml").write_text(yaml.safe_dump(content))
        return load_rig(tmp_path / "rig.yaml")

    return make


def _without_source(value):
    return {k: v for k, v in value.items() if k != "source"} if isinstance(value, dict) else value


def test_a_rig_of_parts_is_the_rig_itself(rig):
    made, whole = rig(), load_rig("hopsan_link")
    assert made.records().tobytes() == whole.records().tobytes()
    assert made.entries["joints.joint.valve.discharge"].source == "sheet of the valve"


def test_what_the_rig_states_goes_over_its_part(rig):
    def change(tree):
        tree["joints"]["joint"]["valve"]["discharge"] = {"value": 0.61, "unit": "1", "source": "measured"}

    entry = rig(change).entries["joints.joint.valve.discharge"]
    assert (entry.value, entry.source) == (0.61, "measured")


def test_a_source_at_the_head_of_a_rig_counts_where_a_number_states_none(rig):
    def change(tree):
        tree["source"] = "sheet of the machine"
        del tree["supply"]["pressure"]["source"]

    made = rig(change)
    assert made.entries["supply.pressure"].source == "sheet of the machine"
    assert made.entries["supply.tank_pressure"].source == "data sheet"


def test_parts_may_use_parts_but_not_themselves(rig):
    made = rig(fluid={"uses": "oil.yaml"}, oil={"source": "oil", "density": {"value": 880, "unit": "kg/m^3"}})
    assert made.value("fluid.density") == 870.0  # nobody uses it

    def change(tree):
        tree["fluid"]["uses"] = "fluid.yaml"
        del tree["fluid"]["density"]

    assert (
        rig(
            change,
            fluid={"uses": "oil.yaml"},
            oil={"source": "a can", "density": {"value": 880, "unit": "kg/m^3"}},
        ).value("fluid.density")
        == 880.0
    )
    with pytest.raises(InputError, match="goes in a circle"):
        rig(change, fluid={"uses": "fluid.yaml"})


@pytest.mark.parametrize(
    ("named", "says"), [("none.yaml", "no file 'none.yaml'"), (7, "no file '7'"), ([1], "no file")]
)
def test_a_part_that_is_not_there_is_refused(rig, named, says):
    def change(tree):
        tree["joints"]["joint"]["valve"]["uses"] = named

    with pytest.raises(InputError, match=r"joints.joint.valve.uses") as caught:
        rig(change)
    assert says in str(caught.value)


def test_a_part_that_is_no_mapping_is_refused(rig):
    with pytest.raises(InputError, match="is empty or not a mapping"):
        rig(valve=[1, 2])


def test_a_number_without_any_source_is_refused(rig):
    def change(tree):
        del tree["supply"]["pressure"]["source"]

    with pytest.raises(InputError, match=r"supply\.pressure: 'source' is missing"):
        rig(change)
