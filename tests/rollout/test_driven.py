"""A chain cut where it is measured: recorded signals drive the model in place of a part of it."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.physics.driven import is_driven
from hydrolek_drake.physics.records import JOINT, as_usual
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.by_diagram import moved_by_diagram
from hydrolek_drake.replay.replay import replay
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes

SUPPLY = ("supply.pressure",)
SPOOL = ("joint.spool",)
CHAMBERS = ("joint.pressure_a", "joint.pressure_b")
WRONG = {
    SUPPLY: {"supply.pressure": "6 MPa", "effects.supply.pressure_droop.resistance_Pa_s_per_m3": "0"},
    SPOOL: {"command.delay": "0.3 s", "command.limit": "1 V", "solenoid.spring": "90 kN/m"},
    CHAMBERS: {"valve.max_area_b": "1e-7 m^2", "fluid.bulk_modulus": "0.1 GPa", "supply.pressure": "6 MPa"},
}
"""What is wrong about the rig in the part that the recording replaces."""


@pytest.fixture(scope="module")
def bench():
    """A bench joint whose pump gives way, so that all its signals move."""
    return load_rig("joint_bench", {"effects.supply.pressure_droop.resistance_Pa_s_per_m3": "3e10"})


@pytest.fixture(scope="module")
def recording(bench):
    """What it did, with every signal of the chain, each millisecond."""
    time = np.arange(0.0, 12.0, 1e-3)
    rng = np.random.default_rng(3)
    volts = np.repeat(rng.uniform(-5.0, 5.0, 24), 500)
    done = roll_out(bench.records(), time, volts, time, longest_step=2.5e-4).signals
    return Recording(
        "bench",
        time,
        {
            "joint.command": volts,
            "joint.angle": done.reading,
            "joint.spool": done.spool,
            "joint.pressure_a": done.pressure_a,
            "joint.pressure_b": done.pressure_b,
            "supply.pressure": done.supply_pressure,
        },
        "bench.csv",
    )


def cut(rig, driven_by, wrong=True):
    tree = rig.as_tree()
    tree.setdefault("recording", {})["driven_by"] = list(driven_by)
    from hydrolek_drake.rigs.reading.tree import rig_from_tree

    made = rig_from_tree(tree, rig.path)
    return made.with_settings(WRONG[driven_by]) if wrong else made


def off_deg(replayed):
    return float(np.degrees(np.sqrt(np.mean(replayed.pairs[0].residual ** 2))))


@pytest.mark.parametrize("driven_by", WRONG, ids=["supply", "spool", "chambers"])
def test_what_is_wrong_in_the_part_that_is_replaced_does_not_matter(bench, recording, driven_by):
    whole = replay(bench.with_settings(WRONG[driven_by]), recording)
    assert off_deg(whole) > 2.0
    replayed = replay(cut(bench, driven_by), recording)
    # moments are integrated twice: what lies between the samples of the pressures adds up over the recording
    travel = np.degrees(np.ptp(recording.signal("joint.angle")))
    assert off_deg(replayed) < (0.01 * travel if driven_by == CHAMBERS else 0.05)
    assert not {pair.key for pair in replayed.pairs} & set(driven_by)  # they would agree by themselves
    signals = replayed.outcomes["joint"].signals
    seen = {"supply.pressure": "supply_pressure", "joint.spool": "spool"}
    for key in driven_by:
        shown = getattr(signals, seen.get(key, key.removeprefix("joint.")))
        recorded = recording.signal(key)
        np.testing.assert_allclose(shown, recorded, rtol=0.0, atol=1e-12 * np.abs(recorded).max())


@pytest.mark.parametrize("driven_by", WRONG, ids=["supply", "spool", "chambers"])
def test_the_diagram_is_driven_alike(bench, recording, driven_by):
    rig, short = cut(bench, driven_by), recording.between(0.0, 2.5)
    by_rollout, by_diagram = replay(rig, short), replay(rig, short, by=moved_by_diagram)
    off = by_rollout.outcomes["joint"].signals.position - by_diagram.outcomes["joint"].signals.position
    assert np.degrees(np.abs(off).max()) < 0.05
    assert off_deg(by_diagram) < 0.05


def test_all_at_once_leaves_the_load(bench, recording):
    rig = cut(bench, SUPPLY + SPOOL + CHAMBERS, wrong=False).with_settings({"cylinder.viscous_friction": "0"})
    assert off_deg(replay(rig, recording)) > 1.0  # what is not replaced counts
    free = {path.split(".")[2] for path in rig.free_parameters() if path.startswith("joints.")}
    assert free and not free & {"command", "amplifier", "solenoid", "valve"}
    assert not any(path.startswith(("supply", "fluid")) for path in rig.free_parameters())


def test_without_a_command_where_the_spool_was_recorded(bench, recording):
    signals = {key: values for key, values in recording.signals.items() if key != "joint.command"}
    silent = Recording("silent", recording.time, signals, "silent.csv")
    assert off_deg(replay(cut(bench, SPOOL), silent)) < 0.05
    (experiment,) = experiments_of(cut(bench, SPOOL), silent)
    assert {channel.key for channel in experiment.channels} == {"joint.angle", *CHAMBERS, "supply.pressure"}
    with pytest.raises(InputError, match=r"signal joint.command is missing"):
        replay(cut(bench, SUPPLY), silent)


def test_a_fit_searches_what_is_left(bench, recording):
    """With the supply's pressure recorded its setting is not searched, and a wrong one does no harm."""
    rig = cut(bench, SUPPLY)
    paths = {free.path for free in free_parameters(rig)}
    assert paths and not any("supply" in path for path in paths)
    (experiment,) = experiments_of(rig, recording)
    done = experiment.simulate(rig.records()).signals
    assert np.degrees(np.abs(done.reading - experiment.channels[0].measured).max()) < 0.2


@pytest.mark.long("half a minute: a loop over lanes is compiled")
@pytest.mark.parametrize("driven_by", WRONG, ids=["supply", "spool", "chambers"])
def test_in_lanes_to_the_last_bit(bench, recording, driven_by):
    rig = cut(bench, driven_by)
    (experiment,) = experiments_of(rig, recording.between(0.0, 3.0))
    runs = experiment.run(rig.records()).of(np.repeat(rig.records(), 3))
    for run, lane in zip(runs, roll_out_lanes(runs, at_once=True), strict=True):
        alone = run.outcome()
        for name in ("reading", "pressure_a", "spool", "supply_pressure"):
            np.testing.assert_array_equal(getattr(lane.signals, name), getattr(alone.signals, name))


def test_off_is_the_ordinary_program(bench):
    records = bench.records()
    assert not is_driven(records) and as_usual(records).dtype != JOINT
    assert is_driven(cut(bench, SUPPLY).records()) and as_usual(cut(bench, SUPPLY).records()).dtype == JOINT


def test_without_a_recording_it_is_refused(bench):
    time = np.arange(0.0, 1.0, 0.01)
    with pytest.raises(InputError, match="driven by recorded signals, which there are none of here"):
        roll_out(cut(bench, SUPPLY).records(), time, np.zeros(100), time, longest_step=1e-3)


@pytest.mark.parametrize(
    ("driven_by", "says"),
    [
        ("supply.pressure", "must be a list of recorded signals"),
        (["joint.force"], "'joint.force' drives nothing; choose supply.pressure, joint.spool"),
        (["joint.pressure_a"], "joint.pressure_a alone drives nothing; both of joint.pressure_a and"),
        ([1], "must be a list of recorded signals"),
    ],
)
def test_bad_lists(tmp_path, driven_by, says):
    import yaml

    path = tmp_path / "rig.yaml"
    path.write_text(
        yaml.safe_dump({"schema": 1, "based_on": "joint_bench", "recording": {"driven_by": driven_by}})
    )
    with pytest.raises(InputError, match=says):
        load_rig(str(path))


def test_a_recording_with_holes_is_refused(bench, recording):
    signals = dict(recording.signals) | {"supply.pressure": recording.signal("supply.pressure").copy()}
    signals["supply.pressure"][100:200] = np.nan
    holed = Recording("holed", recording.time, signals, "holed.csv")
    with pytest.raises(InputError, match=r"supply.pressure has no value at 0.1 s"):
        replay(cut(bench, SUPPLY), holed)


def test_an_electric_axis_has_no_oil(tmp_path):
    path = tmp_path / "rig.yaml"
    path.write_text("schema: 1\nbased_on: emps\nrecording:\n  driven_by: [axis.spool]\n")
    with pytest.raises(InputError, match="axis has an electric motor, which has no oil"):
        load_rig(str(path))
