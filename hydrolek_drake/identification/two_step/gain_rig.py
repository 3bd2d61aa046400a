"""The rig of step one: the same joint with a gain in place of its hydraulics, as in section 4.3."""

import copy
from dataclasses import replace

from hydrolek_drake.identification.two_step.settings import two_step_data, with_ranges
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.reading.tree import rig_from_tree
from hydrolek_drake.units import si_factor

REPLACED = ("amplifier", "solenoid", "valve", "cylinder", "linkage")
"""Stages for which the gain stands."""


def gain_path(joint: str) -> str:
    """Full path of the gain K."""
    return f"joints.{joint}.cylinder.force_constant"


def gain_rig(rig: Rig, joint: str) -> Rig:
    """I q'' + g_c cos q + g_s sin q + D q' = K u, (4.1) of one joint with the hydraulics a gain.

    The thesis's stiffness S is not there besides: over a joint's range g_s sin q is such a spring.

    Args:
        rig: of one hydraulic joint.
        joint: its name.
    """
    gain = two_step_data()["step_one"]["gain"]
    factor = si_factor(str(gain["unit"]), "N m/V")
    value, low, high = (factor * float(v) for v in (gain["value"], *gain["range"]))
    tree = copy.deepcopy(rig.tree)
    sections = tree["joints"][joint]
    for stage in ("amplifier", "solenoid", "valve"):
        sections[stage] = {"variant": "none"}
    source = str(gain["source"])
    sections["cylinder"] = {
        "variant": "electric_motor",
        "force_constant": {"value": value, "unit": "N/V", "source": source},  # N m/V at a turning joint
    }
    zero = {
        "value": rig.value(f"joints.{joint}.load.lower_stop"),
        "unit": "rad",
        "source": "nothing moves with it",
    }
    way = {"value": 1.0, "unit": "1", "source": "a positive command moves a joint in its positive direction"}
    sections["linkage"] = {"variant": "direct", "zero_stroke_position": zero, "direction": way}
    sections.pop("effects", None)
    bare = rig_from_tree(tree, rig.path)
    kept = {
        path: rig.entries[path]
        for path in bare.entries
        if path in rig.entries and not any(path.startswith(f"joints.{joint}.{s}.") for s in REPLACED)
    }
    return with_ranges(
        replace(bare, entries={**bare.entries, **kept}), {gain_path(joint): (low, high, "log")}
    )
