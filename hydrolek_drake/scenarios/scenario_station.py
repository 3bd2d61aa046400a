"""The Drake diagram that a scenario names."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hydrolek_drake.scenarios.commands import Playback
from hydrolek_drake.scenarios.scenario import Scenario
from hydrolek_drake.station.simulation import command_source
from hydrolek_drake.station.station import Station, make_station

if TYPE_CHECKING:
    from hydrolek_drake.control.loop_command import LoopCommand


@dataclass(frozen=True)
class ScenarioStation:
    """A scenario's diagram.

    Attributes:
        station: the diagram and handles to it.
        loop: controllers in it, or None.
    """

    station: Station
    loop: "LoopCommand | None"


def scenario_station(
    scenario: Scenario, seed: int | None = None, visualize: Callable[..., None] | None = None
) -> ScenarioStation:
    """Build it.

    Args:
        scenario: loaded with `load_scenario`.
        seed: of random commands and noise; None for the scenario's own and 0.
        visualize: see `make_station`.

    Raises:
        InputError: a joint for which no controller can be built, or see `make_station`.
    """
    noise = np.random.default_rng(0 if seed is None else seed) if scenario.noise else None
    rig, operator, loop = scenario.rig, scenario.operator, None
    if scenario.controlled is None:
        command = command_source(*scenario.command_table(seed))
    else:
        rig, loop, operator = scenario.controlled.command(rig, scenario.duration, scenario.noise)
        command = loop.system
    station = make_station(
        rig,
        sizes=scenario.sizes,
        command=command,
        operator=operator,
        noise=noise,
        recorded=scenario.command.recorded if isinstance(scenario.command, Playback) else None,
        visualize=visualize,
    )
    return ScenarioStation(station, loop)
