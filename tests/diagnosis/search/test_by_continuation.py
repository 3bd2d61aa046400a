"""Structures by continuation: out of local minima that the steps of a race end in."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from hydrolek_drake.challenge.cases import read_case, record
from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.search.best_first import search_structures
from hydrolek_drake.diagnosis.search.by_continuation import continued_nominal
from hydrolek_drake.diagnosis.search.nominal import fit_nominal
from hydrolek_drake.diagnosis.settings import NOISE, Settings
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.splitting import prepared
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_of_joints, free_parameters
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig

STICKS_AND_SLIPS = {
    "drive": "closed",
    "effects": {
        "cylinder.stribeck_friction": {
            "coulomb_N": 66.00204824609787,
            "stribeck_N": 132.00409649219574,
            "stribeck_velocity_m_per_s": 0.13522343090706243,
        }
    },
    "kind": "single",
    "machine": {
        "area_max_a": 1.0834968381541768e-06,
        "area_max_b": 1.5177185908883158e-06,
        "bulk": 938592251.8235867,
        "c_cyl": 14.114028964808016,
        "i_max_a": 1.0765217787485069,
        "i_max_b": 1.1056057789281595,
        "p_s": 14490477.267971816,
        "t_d": 0.2206539216074952,
        "w_a": 0.00019854493362397686,
        "w_b": 0.00013286423063094152,
        "x_o_a": 5.104314366623347e-05,
        "x_o_b": 7.268378461596116e-05,
    },
    "name": "case_026",
    "pressures": True,
    "rig": "hydrolek_right_j4",
    "seed": 455791370,
    "shows": {"cylinder.stribeck_friction": 15.085905139694832},
    "size": "large",
    "stages": ["cylinder"],
    "unlisted": {},
}

RINGS = {
    "drive": "closed",
    "effects": {
        "base.compliance": {"inertia_kg_m2": 6.844842559907019, "stiffness_Nm_per_rad": 4087.254938329977}
    },
    "kind": "single",
    "machine": {
        "area_max_a": 9.042336557628603e-07,
        "area_max_b": 7.349306794157678e-07,
        "bulk": 1090033556.3449843,
        "c_cyl": 3026.777248813011,
        "i_max_a": 0.91577797267378,
        "i_max_b": 0.9046809187063225,
        "p_s": 16886630.55685545,
        "t_d": 0.1448445456306669,
        "w_a": 0.00015035536660431713,
        "w_b": 0.00014062814296926133,
        "x_o_a": 5.94551296857435e-05,
        "x_o_b": 5.4272135228254455e-05,
    },
    "name": "case_024",
    "pressures": True,
    "rig": "hydrolek_right_j3",
    "seed": 1502887913,
    "shows": {"base.compliance": 30.000226607859414},
    "size": "large",
    "stages": ["base"],
    "unlisted": {},
}


HEALTHY = {
    "drive": "open",
    "effects": {},
    "kind": "healthy",
    "machine": {
        "area_max_a": 1.432174654729686e-06,
        "area_max_b": 1.3786874112820052e-06,
        "bulk": 1050779761.0746739,
        "c_cyl": 4183.552902969929,
        "i_max_a": 0.8867682704480258,
        "i_max_b": 1.0030387251921031,
        "p_s": 14126491.87873822,
        "t_d": 0.12164826758819712,
        "w_a": 0.00017710159162865138,
        "w_b": 0.00018393192581782195,
        "x_o_a": 6.890011785681775e-05,
        "x_o_b": 6.563589900087993e-05,
    },
    "name": "case_026",
    "pressures": True,
    "rig": "hydrolek_left_j2",
    "seed": 1740660127,
    "shows": {},
    "size": "",
    "stages": [],
    "unlisted": {},
}


def test_a_dead_time_that_is_off_by_more_than_an_observer_remembers_is_found(bench, recorded, fitted) -> None:
    """Every move has passed before the model makes it: from the rig's own number no slope leads there."""
    late_s = 0.15
    free = [
        replace(p, lower=0.005, upper=0.3, log=False) if p.path.endswith("command.delay") else p
        for p in free_parameters(bench)
        if p.path.endswith(("command.delay", "valve.max_area_a", "valve.max_area_b"))
    ]
    [dead_time] = [p.path for p in free if p.path.endswith("command.delay")]
    training = recorded(bench.with_values({dead_time: late_s}), bench, pressure_noise_Pa=2e4)
    settings = Settings(drawn=0)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free, training, pool, 2, settings=settings)
        [stuck] = race(workbench, [Entrant((), {})], (replace(settings.long[0], rounds=40),))
        led = continued_nominal(workbench, fitted(workbench, rounds=0), NOISE.at)
    assert stuck.fit.over_noise > NOISE.far
    assert led is not None
    assert led.fit.over_noise < NOISE.at
    assert led.values[dead_time] == pytest.approx(late_s, abs=1e-3)


@pytest.mark.thorough
def test_a_healthy_joint_that_sticks_and_slips_is_led_to_the_noise_before_anything_is_added(tmp_path) -> None:
    """Case 620/026: free rollouts from the rig's own numbers end at 21 times the noise."""
    case = read_case(HEALTHY)
    rig = load_rig(case.rig, {})
    record(rig, case, tmp_path)
    train, holdout = (read_recording(tmp_path / f"{side}.csv", rig.columns) for side in ("train", "holdout"))
    training, _, _ = prepared(rig, [train], [holdout], None)
    [joint] = rig.joints
    found = Tried()
    with ThreadPoolExecutor(2) as pool:
        bench = Workbench(rig, free_of_joints(rig, {joint}), training, pool, 2)
        fit_nominal(bench, found)
    assert found.best.fit.over_noise < NOISE.at


@pytest.mark.parametrize(
    ("label", "effect"),
    [
        pytest.param(STICKS_AND_SLIPS, "cylinder.stribeck_friction", id="a joint that sticks and slips"),
        pytest.param(RINGS, "base.compliance", id="a base that rings"),
    ],
)
@pytest.mark.long("a minute each")
def test_a_fit_is_led_out_of_local_minima_to_the_noise(label, effect: str, tmp_path) -> None:
    """Cases of the challenge: 570/026, where the steps of a race end at ten times the noise, and 620/024, at 2.4."""
    case = read_case(label)
    rig = load_rig(case.rig, {})
    record(rig, case, tmp_path)
    train, holdout = (read_recording(tmp_path / f"{side}.csv", rig.columns) for side in ("train", "holdout"))
    training, _, _ = prepared(rig, [train], [holdout], None)
    [joint] = rig.joints
    candidates = [
        c for c in candidates_of(rig, joint, natural_scales(rig, joint, training)) if c.id == effect
    ]
    found = Tried()
    with ThreadPoolExecutor(2) as pool:
        bench = Workbench(rig, free_of_joints(rig, {joint}), training, pool, 2)
        search_structures(bench, candidates, found, lambda text: None)
    assert found.best.effects == tuple(candidates)
    assert found.best.fit.over_noise < NOISE.explained
    for name, value in case.effects[effect].items():
        assert found.best.values[f"{candidates[0].path}.{name}"] == pytest.approx(value, rel=0.05)
