"""A scenario, run on its Drake diagram."""

import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.scenarios.scenario import Scenario
from hydrolek_drake.scenarios.scenario_station import scenario_station
from hydrolek_drake.station.simulation import Run, run
from hydrolek_drake.visualization.station_view import StationView

if TYPE_CHECKING:
    from hydrolek_drake.control.loop_command import LoopCommand

_ROUNDING = 1e-9  # seconds by which a logged time may miss the command's


def held_at(times: np.ndarray, values: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Rows of a command table, each held until the next, at other times; shape (wanted, joints)."""
    rows = np.searchsorted(times, wanted + _ROUNDING, side="right") - 1
    return values[np.clip(rows, 0, len(times) - 1)]


@dataclass(frozen=True)
class ScenarioRun:
    """A scenario with what came out.

    Attributes:
        scenario: what was asked for.
        seed: of random commands and noise; None for the scenario's own and none.
        run: time and signals.
        seconds: how long the run took, without building and compiling.
        loop: the controllers, or None.
    """

    scenario: Scenario
    seed: int | None
    run: Run
    seconds: float
    loop: "LoopCommand | None" = None

    def command_table(self) -> tuple[np.ndarray, np.ndarray]:
        """Times [s], shape (m,), and what was commanded [V or %], shape (m, joints), each held until the next."""
        if self.loop is None:
            return self.scenario.command_table(self.seed)
        rig = self.scenario.rig
        held = self.loop.held("voltage", self.run.final)
        volts = np.tile(rig.records()["command"]["neutral"].astype(float), (len(held), 1))
        volts[:, [rig.joints.index(joint) for joint in self.loop.joints]] += held
        return np.arange(len(held)) * self.loop.sample_s, volts

    def set_points(self) -> dict[str, np.ndarray]:
        """Where controllers were told to bring their joints, at each time of the run [rad], by joint."""
        if self.loop is None:
            return {}
        times = np.arange(len(self.loop.set_points_deg)) * self.loop.sample_s
        held = held_at(times, np.radians(self.loop.set_points_deg), self.run.time)
        return dict(zip(self.loop.joints, held.T, strict=True))


def run_scenario(
    scenario: Scenario,
    *,
    seed: int | None = None,
    view: StationView | None = None,
    realtime_rate: float = 0.0,
    on_progress: Callable[[float], None] | None = None,
) -> ScenarioRun:
    """Build a scenario's diagram and run it to its end, or until the user interrupts.

    Args:
        scenario: loaded with `load_scenario`.
        seed: of random commands and noise.
        view: shows and records the run.
        realtime_rate: 1 to run no faster than real time, 0 as fast as possible.
        on_progress: called with the simulated time now and then.

    Raises:
        InputError: the simulation diverged, which a smaller step cures, or its numbers make no machine.
    """
    try:
        built = scenario_station(scenario, seed, None if view is None else view.add)
    except RuntimeError as error:  # what Drake raises for masses and inertias that no body has
        raise InputError(f"scenario {scenario.name}: its numbers make no machine: {error}") from None
    outcome: list[Run] = []
    begun = clock.perf_counter()

    def go() -> None:
        outcome.append(
            run(
                built.station,
                scenario.duration,
                supply_lost_at=scenario.supply_lost_at,
                realtime_rate=realtime_rate,
                on_progress=on_progress,
                keep_interrupted=True,
            )
        )

    try:
        if view is None:
            go()
        else:
            view.record(go)
    except RuntimeError as error:  # what Drake raises when it meets a number that is none
        if "NaN" not in str(error):
            raise
        outcome.clear()
    if not outcome or not np.isfinite(outcome[0].signals["position"]).all():
        raise InputError(
            f"scenario {scenario.name} diverged at a step of {1e3 * scenario.sizes.step:g} ms; take a smaller one, "
            f"such as --set 'scenario.integration.step={250 * scenario.sizes.step:g} ms'"
        )
    return ScenarioRun(scenario, seed, outcome[0], clock.perf_counter() - begun, built.loop)
