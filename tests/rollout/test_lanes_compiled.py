"""Which loops of lanes are compiled, when, and by whom."""

import math
import os
import subprocess
import sys
from collections import Counter

import numpy as np
import pytest
from lane_runs import SIZES, STEP, drawn_law, in_lanes, varied, with_effect

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.physics.law import TERM_NAMES
from hydrolek_drake.physics.records import flat, position_of
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.lanes import compiling as lane_compiling
from hydrolek_drake.rollout.lanes.kinds import kind_of
from hydrolek_drake.rollout.rollout import with_own


def test_few_kinds_are_compiled():
    rig = load_rig("joint_bench")
    kinds = {
        kind_of(with_effect(rig, effect).records()[:1], 1) for effect in SIZES if effect != "linkage.backlash"
    }
    assert len(kinds) <= 6  # without any, rubbing, warming, sticking, rocking, driven otherwise


def test_a_loop_knows_of_no_friction_where_nothing_rubs():
    """Each of these asks where the machine is, which would keep the loop from vector instructions: twice the time."""
    known = dict(kind_of(load_rig("hydrolek_right_j2").records()[:1], 1).known)
    for effect in EFFECTS.values():
        if {"rod_friction", "rod_damping", "load_friction"} & set(effect.hooks):
            assert position_of(effect.key, effect.size) in known, effect.id


def test_what_a_variant_does_not_have_costs_nothing():
    """Numbers of other variants are not numbers, and constants of the loop: what they would do is left out of it."""
    joint = load_rig("hydrolek_right_j2").records()[:1]
    absent, there = position_of("fluid", "air_exponent"), position_of("cylinder", "stroke")
    known = dict(kind_of(joint, 1).known)
    assert math.isnan(flat(joint)[0][absent]) and math.isnan(known[absent])
    assert there not in known
    # though no NaN is equal to another one, machines that differ in numbers only are of one kind
    longer = joint.copy()
    flat(longer)[0][there] *= 1.1
    assert kind_of(longer, 1) == kind_of(joint, 1)


def test_until_a_loop_is_compiled_machines_go_one_by_one_and_nobody_waits(monkeypatch, tmp_path):
    monkeypatch.setattr(lane_compiling, "_mark", lambda kind: tmp_path / kind.name)
    begun = []
    monkeypatch.setattr(lane_compiling, "_begin", lambda *given: begun.append(given) or _Running())
    rig = load_rig("joint_bench")
    records = varied(rig.records()[:1], np.random.default_rng(7), 60)
    records["fluid"]["floor_time"] = 0.0  # a kind is told by its variants and effects alone
    kind = kind_of(records[:1], 1)
    monkeypatch.setattr(lane_compiling, "_ready", set())
    monkeypatch.setattr(lane_compiling, "_asked", Counter())
    monkeypatch.setattr(lane_compiling, "WORTH", 200)
    asked = [lane_compiling.ready(kind, records[:1], None, 60, 1) for _ in range(8)]
    assert not any(asked) and len(begun) == 1  # after 240 of them; not again while that runs
    (tmp_path / kind.name).touch()  # as the other process does when it is done
    assert lane_compiling.ready(kind, records[:1], None, 60, 1)


@pytest.mark.long("a quarter of a minute: a process compiles a loop")
def test_the_process_compiles_the_loop_that_was_asked_for(tmp_path):
    """A law may stand in the record of its joint already."""
    rig = load_rig("joint_bench")
    records = rig.records()[:1].copy()
    records["law"][TERM_NAMES[0]] = drawn_law(np.random.default_rng(8), 1)
    law = with_own(None, records)
    kind = kind_of(records, 1, law)
    mark = lane_compiling._mark(kind)
    mark.unlink(missing_ok=True)
    assert lane_compiling._begin(records, law, 1).wait(300) == 0
    assert mark.exists()


@pytest.mark.long("three quarters of a minute: both loops are compiled")
def test_a_loop_calls_nothing_whatever_was_compiled_before(tmp_path):
    """A call keeps it from vector instructions; one was left where a machine alone had been compiled in the process."""
    told = subprocess.run(
        [sys.executable, "-c", _BOTH_COMPILED],
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "HYDROLEK_CACHE_DIR": ""},
        capture_output=True,
        text=True,
        check=True,
    )
    calls = told.stdout.split()
    assert "llvm.sqrt.v8f64" in calls
    assert [name for name in calls if not name.startswith("llvm.")] == []


_BOTH_COMPILED = """
import re
import numpy as np
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.lanes import kernel
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.run import Run
record, times = load_rig("hydrolek_right_j2").records()[:1], np.array([0.0, 1e-3])
roll_out(record, times, np.zeros(2), times, longest_step=1e-3)
roll_out_lanes(Run(record, times, np.zeros(2), times, 1e-3).of(np.repeat(record, 8)), at_once=True)
(compiled,) = kernel._all_lanes.overloads.values()
loop = re.search(r"^define[^\\n]*_all_lanes.*?^}", compiled.library.get_llvm_str(), re.M | re.S).group()
print(*re.findall(r"call [^\\n]*?@([\\w.]+)", loop))
"""


class _Running:
    def poll(self):
        return None


def test_another_process_compiles_a_loop_for_all():
    rig = load_rig("joint_bench")
    kind = kind_of(rig.records()[:1], 1)
    in_lanes(rig.records()[:1], np.array([0.0, 1e-3]), np.zeros(2), longest_step=STEP)
    lane_compiling._mark(kind).unlink()
    process = lane_compiling._begin(rig.records()[:1], None, 1)
    assert process.wait(300.0) == 0 and lane_compiling._mark(kind).exists()
