"""The signals of a run under the names that recordings have."""

import numpy as np

from hydrolek_drake.physics.command import calibrated_voltages
from hydrolek_drake.physics.cylinder import ELECTRIC
from hydrolek_drake.runs.running import ScenarioRun, held_at


def commanded_voltages(done: ScenarioRun) -> np.ndarray:
    """What the computer sends each joint at each time of the run [V], shape (n, joints)."""
    commands = held_at(*done.command_table(), done.run.time)
    if not done.scenario.operator:
        return commands
    volts = np.empty_like(commands)
    for column, record in enumerate(done.scenario.rig.records()):
        for percent in np.unique(commands[:, column]):
            raised, lowered = calibrated_voltages(float(percent), record)
            volts[commands[:, column] == percent, column] = raised - lowered
    return volts


def named_signals(done: ScenarioRun) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Signals by `<joint>.<quantity>` with the unit of each, angles in degrees; shape (n,) each."""
    rig, run = done.scenario.rig, done.run
    signals: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}

    def keep(key: str, values: np.ndarray, unit: str) -> None:
        signals[key], units[key] = values, unit

    volts = commanded_voltages(done)
    table = held_at(*done.command_table(), run.time)
    wanted = done.set_points()
    for i, joint in enumerate(rig.joints):
        if joint in wanted:
            keep(f"{joint}.reference", np.degrees(wanted[joint]), "deg")
        if done.scenario.operator:
            keep(f"{joint}.signal", table[:, i], "percent")
        keep(f"{joint}.command", volts[:, i], "V")
        if rig.variant(joint, "load") == "sliding":
            keep(f"{joint}.position", run.signals["measured"][:, i], "m")
            keep(f"{joint}.velocity", run.signals["velocity"][:, i], "m/s")
        else:
            keep(f"{joint}.angle", np.degrees(run.signals["measured"][:, i]), "deg")
            keep(f"{joint}.rate", np.degrees(run.signals["velocity"][:, i]), "deg/s")
        for quantity, unit in (("pressure_a", "Pa"), ("pressure_b", "Pa"), ("spool", "m"), ("current", "A")):
            if quantity in run.signals and (quantity != "current" or rig.tells_current(joint)):
                keep(f"{joint}.{quantity}", run.signals[quantity][:, i], unit)
        by_rod = rig.variant(joint, "cylinder") in ("cylinder", *ELECTRIC)
        if by_rod:
            keep(f"{joint}.force", run.signals["force"][:, i], "N")
    if "supply_pressure" in run.signals:
        keep("supply.pressure", run.signals["supply_pressure"][:, 0], "Pa")
    return signals, units
