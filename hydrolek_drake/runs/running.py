"""A scenario, run on its Drake diagram."""

import time as clock
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.station.scenario import Scenario
from hydrolek_drake.station.simulation import Run, run
from hydrolek_drake.station.station import Station, make_station
from hydrolek_drake.visualization.station_view import StationView


@dataclass(frozen=True)
class ScenarioRun:
    """A scenario with what came out.

    Attributes:
        scenario: what was asked for.
        seed: of random commands and noise; None for the scenario's own and none.
        run: time and signals.
        seconds: how long the run took, without building and compiling.
    """

    scenario: Scenario
    seed: int | None
    run: Run
    seconds: float


def make_scenario_station(
    scenario: Scenario, seed: int | None = None, view: StationView | None = None
) -> Station:
    """The diagram that a scenario names."""
    noise = np.random.default_rng(0 if seed is None else seed) if scenario.noise else None
    return make_station(
        scenario.rig,
        sizes=scenario.sizes,
        command=scenario.command_source(seed),
        operator=scenario.operator,
        noise=noise,
        visualize=None if view is None else view.add,
    )


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
        station = make_scenario_station(scenario, seed, view)
    except RuntimeError as error:  # what Drake raises for masses and inertias that no body has
        raise InputError(f"scenario {scenario.name}: its numbers make no machine: {error}") from None
    outcome: list[Run] = []
    begun = clock.perf_counter()

    def go() -> None:
        outcome.append(
            run(
                station,
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
    return ScenarioRun(scenario, seed, outcome[0], clock.perf_counter() - begun)
