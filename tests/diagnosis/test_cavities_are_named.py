"""A machine whose chambers run empty: what a rig without cavities leaves, and their name."""

import pytest

CAVITIES = "joints.joint.effects.cylinder.cavitation.refilled"
FEW = ("cylinder.cavitation", "fluid.entrained_air", "linkage.backlash", "cylinder.cross_port_leakage")
"""Effects that are candidates; a matter of time."""


@pytest.mark.thorough
def test_cavities_are_named_and_nothing_else(answer_of) -> None:
    answer = answer_of({CAVITIES: 1.0}, FEW, laws=False, largest_V=9.0)
    best = answer.conclusion.best.hypothesis
    assert answer.known.found.baseline.fit.over_noise > 2.0
    assert [c.id for c in best.effects] == ["cylinder.cavitation"]
    assert best.fit.over_noise < 1.06
    assert best.values[CAVITIES] == pytest.approx(1.0, abs=0.05)
