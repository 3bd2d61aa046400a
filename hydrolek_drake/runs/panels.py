"""What the plots of a run show, drawn alike in the browser and on paper."""

from collections.abc import Callable

import numpy as np

from hydrolek_drake.replay.panels import COMMAND_COLOUR, MODEL_COLOUR, RESIDUAL_COLOUR, Line, Panel
from hydrolek_drake.replay.thinning import PLOTTED_POINTS, thinned
from hydrolek_drake.runs.running import ScenarioRun
from hydrolek_drake.runs.signals import named_signals

_MANY = 4  # joints; from here on small multiples, the arms side by side
_POINTS_OF_MANY = 1000
_POSITION_COLOUR, _SIDE_A_COLOUR, _SIDE_B_COLOUR = RESIDUAL_COLOUR, MODEL_COLOUR, "#7570b3"
_SET_POINT_COLOUR = "#7a7a7a"
_SUPPLY_COLOUR = "#1b7837"
_LEAST_SPAN = 1.0  # deg, mm or MPa; what hardly moves is not blown up until rounding fills the plot


def overview(done: ScenarioRun) -> list[list[Panel]]:
    """Position of every joint; of few joints also pressures and command."""
    if len(done.scenario.rig.joints) < _MANY:
        return full(done)
    plots = _Plots(done)
    return plots.arms(lambda joint: [plots.position(joint)])


def full(done: ScenarioRun) -> list[list[Panel]]:
    """Position, pressures and command of every joint."""
    plots = _Plots(done)
    joints = done.scenario.rig.joints
    if len(joints) < _MANY:
        return [[panel for joint in joints for panel in plots.all_of(joint)] + plots.supply()]
    return plots.arms(plots.all_of)


class _Plots:
    """Panels of one run's signals."""

    def __init__(self, done: ScenarioRun):
        self._joints = done.scenario.rig.joints
        self._time = done.run.time
        self._signals, _ = named_signals(done)
        self._points = PLOTTED_POINTS if len(self._joints) < _MANY else _POINTS_OF_MANY

    def arms(self, of_joint: Callable[[str], list[Panel]]) -> list[list[Panel]]:
        """Left arm on the left, right arm on the right, supply beneath."""
        left = [joint for joint in self._joints if joint.startswith("left_")]
        right = [joint for joint in self._joints if joint not in left]
        stacks = [[panel for joint in side for panel in of_joint(joint)] for side in (left, right) if side]
        return [stack + self.supply() for stack in stacks]

    def all_of(self, joint: str) -> list[Panel]:
        return [self.position(joint), *self.pressures(joint), self.command(joint)]

    def position(self, joint: str) -> Panel:
        if f"{joint}.position" in self._signals:
            unit, values = "mm", 1e3 * self._signals[f"{joint}.position"]
        else:
            unit, values = "deg", self._signals[f"{joint}.angle"]
        lines = {"position": (values, _POSITION_COLOUR)}
        if f"{joint}.reference" in self._signals:
            lines = {"set point": (self._signals[f"{joint}.reference"], _SET_POINT_COLOUR), **lines}
        return self._panel(f"{joint} [{unit}]", lines, 1.6)

    def pressures(self, joint: str) -> list[Panel]:
        if f"{joint}.pressure_a" not in self._signals:
            return []
        lines = {
            f"pressure {side.upper()}": (1e-6 * self._signals[f"{joint}.pressure_{side}"], colour)
            for side, colour in (("a", _SIDE_A_COLOUR), ("b", _SIDE_B_COLOUR))
        }
        return [self._panel("pressures [MPa]", lines, 1.3)]

    def command(self, joint: str) -> Panel:
        lines = {"command": (self._signals[f"{joint}.command"], COMMAND_COLOUR)}
        return self._panel("command [V]", lines, 0.8, stepped=True)

    def supply(self) -> list[Panel]:
        if "supply.pressure" not in self._signals:
            return []
        lines = {"supply pressure": (1e-6 * self._signals["supply.pressure"], _SUPPLY_COLOUR)}
        return [self._panel("supply [MPa]", lines, 1.0)]

    def _panel(
        self, title: str, lines: dict[str, tuple[np.ndarray, str]], height: float, stepped: bool = False
    ) -> Panel:
        drawn = tuple(
            Line(name, *thinned(self._time, values, self._points), colour, stepped)
            for name, (values, colour) in lines.items()
        )
        return Panel(title, drawn, (), None, height, least_span=_LEAST_SPAN)
