"""The search for effects where plain least squares gets stuck."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import COARSE, GLANCE, LOOK
from hydrolek_drake.diagnosis.unsticking import fit_pulled, led_on, starts_of, unstuck
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

STRONG = {"coulomb_N": 1700.0, "stribeck_N": 3400.0, "stribeck_velocity_m_per_s": 0.009}
MIDDLE = {"coulomb_N": 806.0, "stribeck_N": 1613.0, "stribeck_velocity_m_per_s": 0.0055}


@pytest.fixture
def sticking(bench, recorded):
    """(Stribeck friction, how it is recorded) -> recordings, and the effect as a candidate."""

    def make(planted, **how):
        paths = {f"effects.cylinder.stribeck_friction.{name}": value for name, value in planted.items()}
        experiments = recorded(bench.with_values(paths), bench, **how)
        scales = natural_scales(bench, "joint", experiments)
        candidates = candidates_of(bench, "joint", scales)
        return experiments, next(c for c in candidates if c.id == "cylinder.stribeck_friction")

    return make


def _found(hypothesis):
    return {path.rpartition(".")[2]: value for path, value in hypothesis.values.items() if "stribeck" in path}


def test_a_fit_of_strong_stick_slip_that_got_stuck_gets_on(bench, sticking) -> None:
    experiments, stribeck = sticking(STRONG, largest_V=4.0, pressure_noise_Pa=2e4, seed=3)
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        step = COARSE * workbench.fine
        glance = workbench.fit((stribeck,), stribeck.starts[0], step, GLANCE)
        stuck = workbench.refit(glance, step, LOOK, tolerance=1e-4)
        best = unstuck(workbench, [glance], [stuck])[0]
    assert stuck.fit.over_noise > 10.0
    # what is left is the error of the coarse step
    assert best.fit.over_noise < 0.25 * stuck.fit.over_noise
    assert _found(best) == {name: pytest.approx(value, rel=0.15) for name, value in STRONG.items()}


def test_differences_from_wide_to_narrow_lead_out_of_a_hollow_near_the_noise(bench, sticking) -> None:
    experiments, stribeck = sticking(MIDDLE, largest_V=3.0, seed=4)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        stuck = [workbench.fit((stribeck,), stribeck.starts[i], workbench.fine, LOOK) for i in (0, 3)]
        led = led_on(workbench, (stribeck,), starts_of((stribeck,)))
    assert min(h.fit.over_noise for h in stuck) > 1.3
    assert led.fit.over_noise < 1.05  # of 1200 values chance moves it by 2 %
    assert _found(led) == {name: pytest.approx(value, rel=0.2) for name, value in MIDDLE.items()}


def test_rollouts_pulled_tightly_at_first_lead_to_a_friction_from_far_off(bench, sticking) -> None:
    """Twenty times the friction that the search begins with, fading over speeds that the rod hardly leaves."""
    planted = {"coulomb_N": 2000.0, "stribeck_N": 4000.0, "stribeck_velocity_m_per_s": 0.02}
    experiments, stribeck = sticking(planted, largest_V=4.0, pressure_noise_Pa=2e4)
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        starts = starts_of((stribeck,))[:2]
        pulled = [fit_pulled(workbench, (stribeck,), [s], workbench.fine, experiments) for s in starts]
        for led in (workbench.refit(fit, workbench.fine, LOOK) for fit in pulled):
            assert led.fit.over_noise < 1.05
            assert _found(led) == {name: pytest.approx(value, rel=0.1) for name, value in planted.items()}
