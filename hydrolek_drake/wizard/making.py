"""From answers to a rig that loads, in steps that are short enough for it."""

from collections.abc import Mapping
from pathlib import Path

from hydrolek_drake.checking.steps import differs, driven_about
from hydrolek_drake.rigs.machine.rig import Rig
from hydrolek_drake.rigs.reading.tree import rig_from_tree
from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.questions import SCREW, fixed, read_answers
from hydrolek_drake.wizard.screw import screw_text
from hydrolek_drake.wizard.sheet import Sheet
from hydrolek_drake.wizard.writing import rig_text
from hydrolek_drake.yaml_files import parse_yaml

MARGIN = 0.5
"""Share of what a step may err by, of one that a new rig gets: other commands and fitted numbers ask for more."""


def text_of(name: str, sheet: Sheet, step: float) -> str:
    """The rig's file with a step of the integration [s], hydraulic or with a servo drive as the sheet says."""
    return (screw_text if sheet["moves"] == SCREW else rig_text)(name, sheet, step)


def written_rig(name: str, given: Mapping[str, str]) -> tuple[str, Rig]:
    """The rig's file and the rig.

    Args:
        name: of the machine.
        given: question -> answer as text, as of `read_answers`.

    Raises:
        InputError: an answer that is none, or one that is missing.
    """
    sheet = Sheet(read_answers(given))
    steps = fixed("steps")
    tried = [step * si_factor(steps["unit"], "s") for step in steps["value"]]
    for step in tried:
        text = text_of(name, sheet, step)
        rig = rig_from_tree(parse_yaml(text, name), Path(f"{name}.yaml"))
        times, volts = driven_about(rig.value("command.limit"), rig.value("command.neutral"))
        off = differs(rig, rig.joints[0], times, volts, step)
        if off is not None and off <= MARGIN:
            break
    return text, rig
