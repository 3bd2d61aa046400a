"""What the wizard states of effects that a machine may have: numbers that count with these alone."""

import numpy as np
import pytest
from sheets import LINK, SLIDE

from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.effects.scales import hydraulic_scales
from hydrolek_drake.wizard.making import written_rig


@pytest.mark.parametrize(("sheet", "moving"), [(LINK, 20.0 * 0.5**2 / 3.0), (SLIDE, 8.0)])
def test_a_worn_pin_is_looked_for_on_every_machine(sheet, moving):
    """From a bare rod to a rocker (1 to 25 % of what moves), from soft brackets to steel (50 to 2000 Hz)."""
    _, rig = written_rig("machine", sheet)
    least, most = rig.entries["joints.joint.linkage.play_inertia"].range
    assert least < 0.01 * moving
    assert most > 0.25 * moving
    inertia = rig.value("linkage.play_inertia")
    softest, hardest = rig.entries["joints.joint.linkage.play_stiffness"].range
    assert np.sqrt(softest / inertia) < 2.0 * np.pi * 50.0
    assert np.sqrt(hardest / inertia) > 2.0 * np.pi * 2000.0
    scales = hydraulic_scales(rig.records()[0], 1e-4, 0.2, 0.5, 40.0, 0.0, (0.2, 0.2))
    [play] = [c for c in candidates_of(rig, "joint", scales) if c.id == "linkage.backlash"]
    assert [free.path.rpartition(".")[2] for free in play.numbers] == [
        "play_inertia", "play_stiffness", "play_damping",
    ]  # fmt: skip


def test_how_far_from_the_axis_a_payload_hangs_is_open_where_its_weight_shows():
    _, link = written_rig("link", LINK)
    lowest, highest = link.entries["joints.joint.load.payload_inertia"].range
    assert lowest < 0.5**2 < highest
    _, upright = written_rig("upright", LINK | {"upright": "yes"})
    assert upright.entries["joints.joint.load.payload_inertia"].range is None


@pytest.mark.parametrize(
    ("centre", "along", "across"), [("0.25, 0 m", 1, 0), ("-0.25, 0 m", -1, 0), ("0, 0.25 m", 0, -1)]
)
def test_what_is_picked_up_hangs_beyond_the_centre_of_mass(centre, along, across):
    """M = m g (x cos q - y sin q), at the end of the link of half a metre."""
    _, rig = written_rig("link", LINK | {"centre": centre})
    assert rig.value("load.payload_gravity_cos") == pytest.approx(along * 9.81 * 0.5)
    assert rig.value("load.payload_gravity_sin") == pytest.approx(across * 9.81 * 0.5)
