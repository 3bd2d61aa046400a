"""The independent check: recordings of another program, replayed with the true machines and effects."""

import json
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

DATA = Path(__file__).parents[1] / "data" / "bench"
LABELS = {label["id"]: label for label in json.loads((DATA / "practice_labels.json").read_text())}
UNLISTED = "practice_14"  # its supply pressure ripples, which no effect of the list does
RIG_PATHS = json.loads((DATA / "rig_paths.json").read_text())
# bench.md: angle noise 0.05 deg rms, pressure noise 0.02 MPa
LARGEST_ANGLE_ERROR_DEG, LARGEST_PRESSURE_ERROR = 0.055, 0.03e6
SIZES = {
    "command.delay": {"delay_s": 0.09},
    "amplifier.gain_fade": {"fraction": 0.1, "time_constant_s": 20.0},
    "valve.asymmetric_overlap": {"shift_m": 1.2e-5},
    "valve.spool_stiction": {"force_N": 0.3},
    "valve.null_leakage": {"conductance_m3_per_s_Pa": 1.5e-13},
    "supply.pressure_droop": {"resistance_Pa_s_per_m3": 6e10},
    "supply.pump_loss": {"fraction": 0.5},
    "fluid.entrained_air": {"air_fraction": 0.15},
    "fluid.warm_up": {"fraction": 0.3, "time_constant_s": 20.0},
    "cylinder.cross_port_leakage": {"conductance_m3_per_s_Pa": 1.5e-12},
    "cylinder.cavitation": {"refilled": 1.0},
    "cylinder.coulomb_friction": {"coulomb_N": 1200.0},
    "cylinder.stribeck_friction": {
        "coulomb_N": 600.0,
        "stribeck_N": 900.0,
        "stribeck_velocity_m_per_s": 5e-3,
    },
    "cylinder.friction_asymmetry": {"coulomb_N": 500.0},
    "cylinder.end_cushion": {"damping_N_s_per_m": 1e5, "length_m": 0.04},
    "linkage.backlash": {"gap_rad": 0.015},
    "base.compliance": {"stiffness_Nm_per_rad": 3e4, "inertia_kg_m2": 80.0},
    "load.payload": {"mass_kg": 5.0, "time_s": 4.0},
    "sensor.nonlinearity": {"amplitude_rad": 0.02},
    "sensor.hysteresis": {"half_width_rad": 0.01},
    "sensor.drift": {"rate_rad_per_min": 0.02},
    "load.coulomb_friction": {"force_N": 40.0},
    "load.stribeck_friction": {
        "force_N": 40.0,
        "stribeck_N": 30.0,
        "stribeck_velocity_m_per_s": 0.02,
    },
    "load.viscous_friction": {"damping_N_s_per_m": 90.0},
    "load.offset_force": {"force_N": 35.0},
    "valve.port_restriction": {"ratio": 0.8},
    "load.friction_asymmetry": {"coulomb_N": 30.0, "damping_N_s_per_m": 40.0},
}


def _errors(bench, pair, part):
    """Angle error [deg rms] and pressure errors [Pa rms] of one recording."""
    label = LABELS[pair]
    values = {RIG_PATHS[name]: value for name, value in label["machine"].items()}
    for effect, parameters in label["effects"].items():
        if effect in EFFECTS:
            values |= {f"effects.{effect}.{name}": value for name, value in parameters.items()}
    rig = bench.with_values(values)
    table = np.genfromtxt(DATA / pair / f"{part}.csv", delimiter=",", names=True, deletechars="")
    time = table["time_s"]
    outcome = roll_out(
        rig.records(),
        time,
        table["joint.command_V"],
        time,
        longest_step=rig.value("integration.longest_step"),
        spool_steps=int(rig.value("integration.spool_steps")),
    )
    assert outcome.diverged is None
    angle = np.degrees(outcome.signals.reading) - table["joint.angle_deg"]
    pressures = [
        getattr(outcome.signals, f"pressure_{side}") - table[f"joint.pressure_{side}_Pa"]
        for side in "ab"
        if f"joint.pressure_{side}_Pa" in table.dtype.names
    ]
    return np.sqrt(np.mean(angle**2)), [np.sqrt(np.mean(p**2)) for p in pressures]


@pytest.mark.parametrize("part", ["train", "holdout"])
@pytest.mark.parametrize("pair", sorted(LABELS.keys() - {UNLISTED}))
def test_the_true_machine_reproduces_its_recording_to_the_noise(bench, pair, part):
    angle, pressures = _errors(bench, pair, part)
    print(f"{pair} {part}: {angle:.4f} deg, {[f'{p / 1e6:.4f} MPa' for p in pressures]}")
    assert len(pressures) == (2 if LABELS[pair]["pressures"] else 0)
    assert angle <= LARGEST_ANGLE_ERROR_DEG
    assert all(p <= LARGEST_PRESSURE_ERROR for p in pressures)


@pytest.mark.parametrize("part", ["train", "holdout"])
def test_a_machine_with_physics_in_no_list_is_not_reproduced(bench, part):
    assert _errors(bench, UNLISTED, part)[0] > LARGEST_ANGLE_ERROR_DEG


def _on_a_pump(effect):
    return EFFECTS[effect].needs.get("supply") == ("pump",)


def test_every_effect_has_a_size_here():
    assert set(EFFECTS) == set(SIZES)


@pytest.mark.parametrize("effect", ["none", *(e for e in EFFECTS if not _on_a_pump(e))])
@pytest.mark.thorough(
    but=("none", "cylinder.coulomb_friction", "cylinder.end_cushion", "linkage.backlash", "base.compliance")
)
def test_rig_s_step_is_fine_enough_with_each_effect_on(bench, effect):
    parameters = {f"effects.{effect}.{name}": value for name, value in SIZES.get(effect, {}).items()}
    error = _step_error_deg(bench, {"load.friction_velocity": np.radians(0.2), **parameters})
    print(f"{effect}: {error:.5f} deg")
    assert error <= 0.02


@pytest.mark.long("a quarter of a minute: loops are compiled")
@pytest.mark.parametrize("effect", [e for e in EFFECTS if _on_a_pump(e)])
def test_rig_s_step_is_fine_enough_with_each_effect_of_a_pump_on(effect):
    parameters = {f"effects.{effect}.{name}": value for name, value in SIZES[effect].items()}
    assert _step_error_deg(load_rig("hopsan_link"), parameters) <= 0.02


@pytest.mark.parametrize("force", [0.1, 0.6, 1.0])
def test_rig_s_step_is_fine_enough_from_slight_to_severe_spool_stiction(bench, force):
    """Severe: twice the 0.48 N at which the spool leaves its overlap."""
    assert _step_error_deg(bench, {"effects.valve.spool_stiction.force_N": force}) <= 0.02


def _step_error_deg(bench, values):
    """Largest difference of the reading between the rig's step and 0.01 ms, over 10 s."""
    rig = bench.with_values(values)
    drive = read_recording(DATA / "practice_01" / "train.csv")
    command = drive.signal("joint.command")
    asked = drive.time <= 10.0
    coarse, fine = (
        roll_out(rig.records(), drive.time, command, drive.time[asked], longest_step=step).signals.reading
        for step in (rig.value("integration.longest_step"), 1e-5)
    )
    return np.degrees(np.abs(coarse - fine)).max()
