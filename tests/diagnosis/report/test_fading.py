"""An effect at a share of its size: sizes go to nothing, moments and time constants stay."""

from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis.report.fading import fade
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.rigs import load_rig


@pytest.mark.parametrize(
    ("effect_id", "fitted", "half", "none"),
    [
        (
            "cylinder.stribeck_friction",
            {"coulomb_N": 800.0, "stribeck_N": 600.0, "stribeck_velocity_m_per_s": 0.02},
            {"coulomb_N": 400.0, "stribeck_N": 300.0, "stribeck_velocity_m_per_s": 0.02},
            {"coulomb_N": 0.0, "stribeck_N": 0.0, "stribeck_velocity_m_per_s": 0.02},
        ),
        (
            "fluid.warm_up",
            {"fraction": 0.2, "time_constant_s": 20.0},
            {"fraction": 0.1, "time_constant_s": 20.0},
            {"fraction": 0.0, "time_constant_s": 20.0},
        ),
        (
            "load.payload",
            {"mass_kg": 10.0, "time_s": 4.0},
            {"mass_kg": 5.0, "time_s": 4.0},
            {"mass_kg": 0.0, "time_s": 4.0},
        ),
        (
            "command.delay",
            {"delay_s": 0.08},
            {"delay_s": 0.04},
            {"delay_s": 0.0},
        ),
        (
            "base.compliance",  # half as soft is twice as stiff, and not soft at all is the neutral value
            {"stiffness_Nm_per_rad": 1e5, "inertia_kg_m2": 30.0},
            {"stiffness_Nm_per_rad": 2e5, "inertia_kg_m2": 30.0},
            {"stiffness_Nm_per_rad": 0.0, "inertia_kg_m2": 30.0},
        ),
    ],
)
def test_sizes_fade_and_the_rest_stays(effect_id, fitted, half, none) -> None:
    rig, effect = load_rig("joint_bench", {}), EFFECTS[effect_id]
    machine = rig.with_values({f"joints.joint.effects.{effect_id}.{k}": v for k, v in fitted.items()})
    candidate = SimpleNamespace(effect=effect, joint="joint")
    for share, wanted in ((1.0, fitted), (0.5, half), (0.0, none)):
        records = machine.records()
        fade(SimpleNamespace(rig=rig), records, candidate, share)
        own = records[0]["effects"][effect.key]
        assert {name: float(own[name]) for name in wanted} == pytest.approx(wanted)


def test_an_effect_on_the_supply_fades_at_every_joint_that_feels_it(two_joints) -> None:
    path = f"joints.{two_joints.joints[0]}.effects.supply.pressure_droop.resistance_Pa_s_per_m3"
    records = two_joints.with_values({path: 6e10}).records()
    effect = EFFECTS["supply.pressure_droop"]
    candidate = SimpleNamespace(effect=effect, joint=two_joints.joints[0])
    fade(SimpleNamespace(rig=two_joints), records, candidate, 0.25)
    droops = [float(row["effects"][effect.key]["resistance_Pa_s_per_m3"]) for row in records]
    assert len(droops) == 2 and droops == pytest.approx([1.5e10, 1.5e10])
