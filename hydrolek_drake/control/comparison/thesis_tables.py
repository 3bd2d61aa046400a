"""Results that the thesis prints, of its SDP models (`thesis_tables.yaml`) and its machine (`thesis_machine.yaml`)."""

from typing import Any

from hydrolek_drake.yaml_files import package_yaml

JOINTS = ("j1", "j2", "j3", "j4", "j4_linear")
"""Order of the values of a row; the last is joint 4 with the linear SDP model of Table 6.7, where it is printed."""

_AXES = ("x", "y", "z")
_MODELS = package_yaml(__package__, "thesis_tables.yaml")
_MACHINE = package_yaml(__package__, "thesis_machine.yaml")


def _row(key: str, value: Any) -> Any:
    if isinstance(value, list):
        return dict(zip(_AXES if key.startswith("tool_variance") else JOINTS, value, strict=False))
    return value if isinstance(value, str) else float(value)


def _by_joint(tree: dict[str, Any], sequence: str) -> dict[str, dict[str, Any]]:
    return {
        controller: {key: _row(key, value) for key, value in rows.items()}
        for controller, rows in tree[sequence].items()
    }


STEP_TABLES = _by_joint(_MODELS, "step")
"""Controller -> measure -> joint -> value: Tables G.3, G.4, 6.9 and 6.10."""

SINE_TABLES = _by_joint(_MODELS, "sine")
"""The same for Tables G.1, G.2 and 6.11."""

GRASP_TABLES = _by_joint(_MODELS, "grasp")
"""The same for Tables G.5 and G.6."""

MACHINE_TABLES = {sequence: _by_joint(_MACHINE, sequence) for sequence in ("step", "sine", "grasp")}
"""Sequence -> controller -> measure -> joint -> value measured on the machine: Tables 7.3 to 7.5, G.7 to G.11."""

MODEL_LESS_MACHINE = _by_joint(_MACHINE, "model_less_machine")
"""Controller -> measure -> joint -> value: Table 7.2."""

_PRINTED = {
    "sdp": {"step": STEP_TABLES, "sine": SINE_TABLES, "grasp": GRASP_TABLES},
    "full": MACHINE_TABLES,
}


def printed(plant: str, sequence: str, controller: str, key: str, joint: str) -> float:
    """What the thesis prints for a controller: of its SDP models beside "sdp", of its machine beside "full".

    Args:
        plant: "sdp" or "full".
        sequence: step, sine or grasp.
        controller: name in the catalogue.
        key: of a measure, such as "rise_s"; "euclidean_mm" is one number for the arm.
        joint: "j1" to "j4", "j4_linear"; on the machine with its arm, of which the thesis has the right one
            only; the arm's own name for "euclidean_mm".

    Returns:
        The value, NaN where nothing is printed.
    """
    if plant == "full":
        arm, _, joint = joint.partition("_")
        if arm != "right":
            return float("nan")
    same = _MACHINE["compared_as"] if plant == "full" else {}
    found = _PRINTED[plant].get(sequence, {}).get(same.get(controller, controller), {}).get(key)
    if isinstance(found, dict):
        found = found.get(joint)
    return float("nan") if found is None else float(found)
