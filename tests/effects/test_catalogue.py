"""All effects: what they declare, that neutral means not there, that on means something."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import hydrolek_drake
from hydrolek_drake.effects import EFFECTS, HOOKS, Effect, effect_named
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.records import STAGES
from hydrolek_drake.rollout import kernel
from hydrolek_drake.units import si_factor

# the contract's table "Effects: ids and parameters"
CONTRACT = {
    "command.delay": ["delay_s"],
    "amplifier.gain_fade": ["fraction", "time_constant_s"],
    "valve.asymmetric_overlap": ["shift_m"],
    "valve.spool_stiction": ["force_N"],
    "valve.null_leakage": ["conductance_m3_per_s_Pa"],
    "supply.pressure_droop": ["resistance_Pa_s_per_m3"],
    "fluid.entrained_air": ["air_fraction"],
    "fluid.warm_up": ["fraction", "time_constant_s"],
    "cylinder.cross_port_leakage": ["conductance_m3_per_s_Pa"],
    "cylinder.coulomb_friction": ["coulomb_N"],
    "cylinder.stribeck_friction": ["coulomb_N", "stribeck_N", "stribeck_velocity_m_per_s", "fading_exponent"],
    "cylinder.end_cushion": ["damping_N_s_per_m", "length_m"],
    "linkage.backlash": ["gap_rad"],
    "base.compliance": ["stiffness_Nm_per_rad", "inertia_kg_m2"],
    "load.payload": ["mass_kg", "time_s"],
    "sensor.nonlinearity": ["amplitude_rad"],
    "sensor.hysteresis": ["half_width_rad"],
    "sensor.drift": ["rate_rad_per_min"],
    "load.coulomb_friction": ["force_N"],
    "load.viscous_friction": ["damping_N_s_per_m"],
    "load.offset_force": ["force_N"],
}
# every parameter away from its neutral value, of a size that a machine may have
ON = {
    "command.delay": {"delay_s": 0.03},
    "amplifier.gain_fade": {"fraction": 0.1, "time_constant_s": 5.0},
    "valve.asymmetric_overlap": {"shift_m": 1e-5},
    "valve.spool_stiction": {"force_N": 0.2},
    "valve.null_leakage": {"conductance_m3_per_s_Pa": 1e-13},
    "supply.pressure_droop": {"resistance_Pa_s_per_m3": 3e10},
    "supply.pump_loss": {"fraction": 0.6},
    "fluid.entrained_air": {"air_fraction": 0.05},
    "fluid.warm_up": {"fraction": 0.2, "time_constant_s": 5.0},
    "cylinder.cross_port_leakage": {"conductance_m3_per_s_Pa": 1e-12},
    "cylinder.cavitation": {"refilled": 1.0},
    "cylinder.coulomb_friction": {"coulomb_N": 500.0},
    "cylinder.stribeck_friction": {
        "coulomb_N": 300.0,
        "stribeck_N": 400.0,
        "stribeck_velocity_m_per_s": 5e-3,
        "fading_exponent": 1.0,
    },
    "cylinder.friction_asymmetry": {"coulomb_N": 400.0},
    "cylinder.end_cushion": {"damping_N_s_per_m": 1e5, "length_m": 0.03},
    "linkage.backlash": {"gap_rad": 0.01},
    "base.compliance": {"stiffness_Nm_per_rad": 4e4, "inertia_kg_m2": 60.0},
    "load.payload": {"mass_kg": 4.0, "time_s": 2.0},
    "sensor.nonlinearity": {"amplitude_rad": 0.01},
    "sensor.hysteresis": {"half_width_rad": 0.005},
    "sensor.drift": {"rate_rad_per_min": 0.01},
    "load.coulomb_friction": {"force_N": 30.0},
    "load.stribeck_friction": {
        "force_N": 30.0,
        "stribeck_N": 20.0,
        "stribeck_velocity_m_per_s": 0.02,
        "fading_exponent": 1.0,
    },
    "load.viscous_friction": {"damping_N_s_per_m": 50.0},
    "load.offset_force": {"force_N": 25.0},
    "valve.port_restriction": {"ratio": 0.8},
    "load.friction_asymmetry": {"coulomb_N": 20.0, "damping_N_s_per_m": 30.0},
}
NEW_EFFECT = """
from numba import njit
from hydrolek_drake.effects.effect import Effect
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="load.wind", title="wind", equation="a constant force", size="force_N", source="a test",
    parameters=(Parameter("force_N", "N", "wind", neutral=0.0),),
)

@EFFECT.hook("load_friction")
@njit
def load_friction(velocity, joint):
    return joint.effects.load_wind.force_N, 0.0
"""
USE_IT = """
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.physics import load
from hydrolek_drake.rigs import load_rig
rig = load_rig("joint_bench", {"effects.load.wind.force_N": "13 N"})
assert rig.effects_on("joint") == ("load.wind",)
print(EFFECTS["load.wind"].title, load.passive_load(0.3, 0.0, rig.records()[0])[0])
"""


def _values(effect_id, parameters):
    return {f"effects.{effect_id}.{name}": value for name, value in parameters.items()}


@pytest.mark.parametrize("effect_id", CONTRACT)
def test_ids_and_parameters_of_the_contract_are_there_by_name(effect_id):
    assert [p.name for p in EFFECTS[effect_id].parameters] == CONTRACT[effect_id]


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS.keys())
def test_an_effect_says_what_it_is(effect):
    assert effect.stage in STAGES
    assert effect.title and effect.equation and len(effect.source) > 15
    assert effect.confused_with and all(len(text) > 20 for text in effect.confused_with.values())
    assert set(effect.confused_with) <= EFFECTS.keys() - {effect.id}
    assert effect.size in [p.name for p in effect.parameters]
    assert effect.hooks and effect.hooks.keys() <= HOOKS.keys()
    for section, variants in effect.needs.items():
        assert set(variants) <= STAGES[section].variants.keys()


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS.keys())
def test_an_effect_s_parameters_have_neutral_values_and_their_unit_in_their_name(effect):
    for p in effect.parameters:
        assert p.neutral is not None and p.lowest <= p.neutral <= p.highest and p.meaning
        assert si_factor("1 " + p.unit, p.unit) == 1.0  # pint knows it
        # the name ends in its unit as columns of recordings spell it; a share or a number has none
        spelled = re.sub(r"[ /]", "_per_" if "/" in p.unit else "_", p.unit) if p.unit != "1" else ""
        last = re.sub(r"[^A-Za-z0-9]", "", spelled.split("_")[0])
        assert last in p.name


@pytest.mark.parametrize("effect_id", EFFECTS)
def test_neutral_changes_nothing_bit_for_bit(drive, machine_for, effect_id):
    """With its size neutral and every other parameter of it away from neutral."""
    size = EFFECTS[effect_id].size
    others = {name: value for name, value in ON[effect_id].items() if name != size}
    if effect_id == "cylinder.stribeck_friction":
        others["coulomb_N"] = 0.0  # a size of its own: without it the effect is Coulomb friction
    if effect_id == "load.stribeck_friction":
        others["force_N"] = 0.0
    if effect_id == "load.friction_asymmetry":
        others = {}  # two sizes
    rig = machine_for(effect_id)
    plain, neutral = drive(rig=rig), drive(_values(effect_id, others), rig=rig)
    for name in kernel.SIGNALS:
        np.testing.assert_array_equal(getattr(plain, name), getattr(neutral, name))


@pytest.mark.parametrize("effect_id", EFFECTS)
def test_switched_on_it_shows_in_the_reading(drive, machine_for, effect_id):
    assert set(ON[effect_id]) == {p.name for p in EFFECTS[effect_id].parameters}
    rig = machine_for(effect_id)
    on, off = drive(_values(effect_id, ON[effect_id]), rig=rig), drive(rig=rig)
    change = np.abs(on.reading - off.reading).max()
    assert np.degrees(change) > 0.05  # the bench's noise


@pytest.mark.parametrize("effect_id", EFFECTS)
def test_a_rig_knows_which_effects_are_on(machine_for, effect_id):
    rig = machine_for(effect_id)
    assert rig.effects_on("joint") == ()
    assert rig.with_values(_values(effect_id, ON[effect_id])).effects_on("joint") == (effect_id,)


def test_a_new_file_is_found_and_acts_without_any_other_change(tmp_path):
    package = Path(hydrolek_drake.__file__).parent
    copied = tmp_path / package.name
    shutil.copytree(package, copied, ignore=shutil.ignore_patterns("__pycache__"))
    (copied / "effects" / "listed" / "mechanical" / "load_wind.py").write_text(NEW_EFFECT)
    done = subprocess.run(
        [sys.executable, "-c", USE_IT],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["wind", "13.0"]


def test_an_unknown_id_is_refused_with_the_nearest_ones():
    with pytest.raises(
        InputError, match=r"no effect 'cylinder.colomb_friction'; did you mean cylinder.coulomb"
    ):
        effect_named("cylinder.colomb_friction")


def test_an_effect_cannot_hook_where_there_is_none():
    effect = Effect("load.x", "x", "x", (Parameter("a", "1", "a", neutral=0.0),), "a", "x")
    with pytest.raises(ValueError, match="no hook 'gravity'; there are command_delay"):
        effect.hook("gravity")


def test_a_file_that_needs_the_composed_effects_is_refused_before_any_is_lost(tmp_path):
    package = Path(hydrolek_drake.__file__).parent
    copied = tmp_path / package.name
    shutil.copytree(package, copied, ignore=shutil.ignore_patterns("__pycache__"))
    text = "from hydrolek_drake.physics import fluid\n" + NEW_EFFECT
    (copied / "effects" / "listed" / "hydraulic" / "fluid_wind.py").write_text(text)
    done = subprocess.run(
        [sys.executable, "-c", "import hydrolek_drake.effects"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    assert "fluid_wind imports a module of physics that composes the effects" in done.stderr
