"""Rigs, scenarios and models for a design: everything that is written by hand in YAML."""

import functools
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from component_machines import machine_text, sound

from fuzzing.byte_damage import damaged
from fuzzing.target import Input, Target
from fuzzing.tree_damage import damaged_text, damaged_tree, words_of
from hydrolek_drake.control.designed import design_controller, read_model, write_designed
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.records import JOINT_STAGES, SHARED_STAGES
from hydrolek_drake.rigs import built_in_rigs, load_rig
from hydrolek_drake.rollout.rollout import roll_out
from hydrolek_drake.runs.running import run_scenario
from hydrolek_drake.scenarios.scenario import load_scenario, scenario_files

_NAME = "mine.yaml"
_STEPS = 5  # that what was read has to bear: values that are possible one by one
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_RIGS = (
    "schema: 1\nbased_on: hydrolek\nkeep: [right_j2, right_j3]\ntitle: two joints\n",
    """schema: 1
based_on: joint_bench
joints:
  joint:
    law:
      - enters: cylinder
        factors: {place: z, speed: sign(v)}
        seen: rod
        sine: {value: 310.0, unit: N, source: here}
        low: {value: 0.0, unit: m, source: here}
        high: {value: 0.2, unit: m, source: here}
        slow: {value: 0.001, unit: m/s, source: here}
    effects:
      command.delay: {delay_s: {value: 10, unit: ms, source: here}}
      load.payload: {mass_kg: {value: 5, unit: kg, source: here, range: [0, 20]}}
""",
    "schema: 1\nbased_on: joint_bench\nrecording:\n"
    "  columns: {P_S: supply.pressure_bar, '/valve.data[1]': joint.spool_mm}\n"
    "  driven_by: [supply.pressure, joint.spool, joint.pressure_a, joint.pressure_b]\n",
)
_SCENARIOS = (
    "schema: 1\ntitle: t\nrig: joint_bench\nsettings: {supply.pressure: 12 MPa}\nduration: 2 s\n"
    "command: {kind: constant, joints: {joint: 2 V}}\ninitial_position: {joint: 20 deg}\n"
    "events: {supply_lost_at: 1 s, commands_zero_at: 1.5 s}\n"
    "integration: {step: 1 ms, plant_step: 0, log_period: 10 ms, integrator: runge_kutta3}\n"
    "forces: mounts\nnoise: false\n",
    "schema: 1\nrig: joint_bench\nduration: 3 s\n"
    "command: {kind: random, joints: [joint], amplitude: 4 V, levels: 17, hold: [0.2 s, 1 s], seed: 1}\n",
    "schema: 1\nrig: joint_bench\nduration: 3 s\n"
    "command: {kind: steps, operator: true, joints: {joint: [[0 s, 0], [1 s, 40 %], [2 s, -40 %]]}}\n",
    "schema: 1\nrig: joint_bench\nduration: 1 s\ncommand: {kind: recording, path: run.csv}\n",
    "schema: 1\nrig: joint_bench\nduration: 1 s\n"
    "command: {kind: controlled, controller: {joint: pi}, joints: {joint: [[0 s, 5 deg], [1 s, 10 deg]]}}\n",
    "schema: 1\nrig: joint_bench\nduration: 1 s\n"
    "command: {kind: controlled, controller: pi, joints: {joint: {recording: run.csv, signal: joint.angle}}}\n",
)
_MODELS = (
    "joint: j2\nalpha: [-0.18, 0.62, -1.09, 0.22, 0.98, 1.05]\nsample_s: 0.01\ndelay_samples: 6\n"
    "range_deg: [-10, 60]\n",
    "alpha: [0.14, 0.13, -0.1, 0.1]\nbeta: [-0.2, -1.1, 0.2, 1.0, -2.6, 3.0]\nsample_s: 0.01\ndelay_samples: 6\n"
    "range_deg: [-60, 60]\n",
    "schema: 1\njoint: j1\nmodel: {alpha: [-0.2, 0.6, -1.1, 0.2, 1.0, 1.0], beta: null, sample_s: 0.01,\n"
    "  delay_samples: 3, range_deg: [-20, 20]}\n",
)


def _built_in(files: Callable[[], dict[str, Path]], names: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(files()[name].read_text(encoding="utf-8") for name in names)


@functools.cache
def _rig_texts() -> tuple[str, ...]:
    components = tuple(machine_text(name) for name in sound())
    return (
        _RIGS + 2 * _built_in(built_in_rigs, ("joint_bench", "emps", "festo_tp511", "patu_lift")) + components
    )


@functools.cache
def _scenario_texts() -> tuple[str, ...]:
    return 5 * (_SCENARIOS + _built_in(scenario_files, ("random_one_joint",))) + _built_in(
        scenario_files, ("step_one_joint", "both_arms")
    )


@functools.cache
def _trees(texts: Callable[[], tuple[str, ...]]) -> tuple[Any, ...]:
    return tuple(yaml.load(text, Loader=_LOADER) for text in texts())


@functools.cache
def _words(texts: Callable[[], tuple[str, ...]]) -> list[str]:
    stages = {**SHARED_STAGES, **JOINT_STAGES}
    names = [*stages, *EFFECTS, "variant", "same_as", "like", "range", "scale", "law", "keep", "based_on"]
    for stage in stages.values():
        for variant in stage.variants:
            names += [variant, *(p.name for p in stage.parameters(variant))]
    return list(dict.fromkeys([*words_of(_trees(texts)), *names]))


def _made(texts: Callable[[], tuple[str, ...]], rng: np.random.Generator) -> Input:
    everything = texts()
    number = int(rng.integers(len(everything)))
    kind = rng.random()
    text = everything[number]
    if texts is _scenario_texts and rng.random() < 0.4:
        text = yaml.dump(_trees(texts)[number] | {"settings": _settings(rng)})
    elif kind < 0.75:
        text = damaged_tree(_trees(texts)[number], _words(texts), _trees(texts), rng)
    if kind > 0.65:
        text = damaged_text(text, rng)
    data = text.encode("utf-8", "replace")
    if kind > 0.93:
        data = damaged(data, [each.encode() for each in everything], rng)
    return Input(_NAME, data)


@functools.cache
def _parameters() -> list[str]:
    return list(load_rig("joint_bench").entries)


def _settings(rng: np.random.Generator) -> dict[str, Any]:
    """Values of a rig that are possible one by one, far from usual or not."""
    rig = load_rig("joint_bench")
    chosen = rng.choice(_parameters(), int(rng.integers(1, 4)))
    factors = [0.0, 1e-300, 1e-9, 0.1, 0.9, 1.1, 10.0, 1e9, 1e300, -1.0]
    return {
        str(path): float(rng.choice([1.0, rig.entries[str(path)].value])) * float(rng.choice(factors))
        for path in chosen
        if np.isfinite(rig.entries[str(path)].value)
    }


def _read_rig(path: Path) -> str:
    rig = load_rig(path).by_itself()
    records = rig.records()
    step = rig.value("integration.longest_step")
    for record in np.split(records, len(records)):
        neutral = float(record["command"]["neutral"][0])
        roll_out(
            record,
            np.array([0.0, 3.0 * step]),
            np.array([neutral, neutral + 1.0]),
            step * np.arange(_STEPS),
            longest_step=step,
            spool_steps=int(rig.value("integration.spool_steps")),
        )
    again = path.with_name("again.yaml")
    again.write_text(yaml.dump(rig.as_tree(), Dumper=getattr(yaml, "CSafeDumper", yaml.SafeDumper)))
    try:
        load_rig(again).records()
    except ValueError as error:
        raise AssertionError(f"what was written of it is not read: {error}") from error
    return "read"


def _read_scenario(path: Path) -> str:
    scenario = load_scenario(path)
    if scenario.controlled is not None:
        table = scenario.controlled.table_deg(scenario.duration, 0.05)
        assert not np.isinf(table).any(), "set points that are no numbers"
        return "read"
    times, values = scenario.command_table()
    assert np.isfinite(times).all() and np.isfinite(values).all(), "commands that are no numbers"
    try:
        run_scenario(replace(scenario, duration=min(scenario.duration, _STEPS * scenario.sizes.step)))
    except InputError:
        return "not run"
    return "read"


def _read_design(path: Path) -> str:
    model = read_model(path)
    try:
        designed = design_controller(model, weights=(1.0, 1.0, 1.0))
    except InputError as error:  # names the joint
        assert model.name in str(error)
        return "no design"
    written = path.with_name("controller.yaml")
    write_designed(designed, written)
    try:
        read_model(written)
    except ValueError as error:
        raise AssertionError(f"what was written of it is not read: {error}") from error
    return "read"


def _recording_beside(folder: Path) -> None:
    (folder / "run.csv").write_text("time_s,joint.command_V,joint.angle_deg\n0,0,20\n0.5,1,20\n1,0,21\n")


def _seeds(texts: Callable[[], tuple[str, ...]]) -> Callable[[], list[Input]]:
    return lambda: [Input(_NAME, text.encode()) for text in dict.fromkeys(texts())]


def _models() -> tuple[str, ...]:
    return _MODELS


TARGETS = (
    Target("rig", functools.partial(_made, _rig_texts), _read_rig, _seeds(_rig_texts)),
    Target(
        "scenario",
        functools.partial(_made, _scenario_texts),
        _read_scenario,
        _seeds(_scenario_texts),
        _recording_beside,
    ),
    Target("design", functools.partial(_made, _models), _read_design, _seeds(_models)),
)
