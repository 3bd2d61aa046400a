"""Effects that are there as soon as they are: which these are."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

FADED = 1e-3
"""Of a size, at which nothing must be left of an effect that fades with it, but for a tenth."""


@pytest.fixture
def fading(bench, recorded):
    """Effect -> change of the residuals at a thousandth of where its search begins, over that where it begins."""
    experiments = recorded(bench, bench, largest_V=4.0)
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool, 2)

        def changed(candidate, factor):
            start = dict(candidate.starts[0])
            moments = {free.path for free in candidate.moments}
            sizes = [
                p.name
                for p in candidate.effect.parameters
                if p.neutral == 0.0 and f"{candidate.path}.{p.name}" not in moments
            ] or [candidate.effect.size]
            start |= {
                f"{candidate.path}.{name}": factor * start[f"{candidate.path}.{name}"] for name in sizes
            }
            problem = workbench.problem((candidate,), 0.5 * workbench.fine)
            return problem.residuals(problem.parameters.unit(start))

        plain = workbench.problem((), 0.5 * workbench.fine)
        nominal = plain.residuals(plain.parameters.unit({}))
        found = {}
        for candidate in candidates_of(bench, "joint", natural_scales(bench, "joint", experiments)):
            weak = 1.0 / FADED if candidate.effect.weakens else FADED
            small, large = (np.linalg.norm(changed(candidate, f) - nominal) for f in (weak, 1.0))
            if large > 0.0:  # a cushion is not reached
                found[candidate.id] = small / large
    return found


def test_an_effect_fades_with_its_size_unless_it_is_called_sudden(fading):
    assert {name for name, share in fading.items() if share > 0.1} == {
        name for name in fading if EFFECTS[name].sudden
    }
