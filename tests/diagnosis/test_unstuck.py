"""The search for effects where plain least squares gets stuck."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import COARSE, GLANCE, LOOK
from hydrolek_drake.diagnosis.unsticking import unstuck
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

STRIBECK = {"coulomb_N": 1700.0, "stribeck_N": 3400.0, "stribeck_velocity_m_per_s": 0.009}


def test_a_fit_of_strong_stick_slip_that_got_stuck_gets_on(bench, recorded) -> None:
    paths = {f"effects.cylinder.stribeck_friction.{name}": value for name, value in STRIBECK.items()}
    experiments = recorded(bench.with_values(paths), bench, largest_V=4.0, pressure_noise_Pa=2e4)
    scales = natural_scales(bench, "joint", experiments)
    stribeck = {c.id: c for c in candidates_of(bench, "joint", scales)}["cylinder.stribeck_friction"]
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        step = COARSE * workbench.fine
        glance = workbench.fit((stribeck,), stribeck.starts[0], step, GLANCE)
        stuck = workbench.refit(glance, step, LOOK, tolerance=1e-4)
        best = unstuck(workbench, [glance], [stuck], step)[0]
    found = {path.rpartition(".")[2]: value for path, value in best.values.items() if "stribeck" in path}
    # what is left is the error of the coarse step
    assert best.fit.over_noise < 0.25 * stuck.fit.over_noise
    assert found == {name: pytest.approx(value, rel=0.15) for name, value in STRIBECK.items()}
