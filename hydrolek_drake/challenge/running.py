"""How a concealed machine of either kind is run: integration, sampling, the way of its command and its sensor.

The equations are the machines' own; none of this comes from the rollout that diagnoses them.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.challenge.driving import SAMPLE_S, Driving, Played, controlled, turned_back, unhindered
from hydrolek_drake.challenge.faulty_signals import lost, worn

STEP_S = 2e-5
"""Half of it changes the angle by 1.2e-4 deg at most, with a play by 1.6e-3 deg
(docs/evidence/concealed_effects.md)."""

SIZE = 14
"""Of a state: x, x', P_A, P_B, q, q', flow felt by the supply, cylinder's side and its rate, tilt and its rate, flow
felt by the return line, currents of coils that take time."""


@njit(inline="always")  # a function that is handed on as an argument could not be kept between runs
def run(
    rates: Any,
    travelled: Any,
    g: Any,
    driving: Any,
    closed: bool,
    series: np.ndarray,
    noise: np.ndarray,
    y: np.ndarray,
    volts: np.ndarray,
    out: np.ndarray,
    inner: int,
) -> None:
    """Run through all samples, in classic Runge-Kutta steps of fourth order.

    Args:
        rates: machine, state, voltage and time -> rates of the state, compiled.
        travelled: machine and angle -> its place in the sensor's travel, from -1 to 1, compiled.
        g: the machine.
        driving: controller, and where voltages are turned round.
        closed: whether a controller drives.
        series: the command [V], or the set points of a controller [rad]. # (n,)
        noise: what the controller's measurement adds [rad]. # (n,)
        y: state at the beginning; is run on. # (SIZE,)
        volts: is given the voltages [V]. # (n,)
        out: is given reading [rad] and chamber pressures [Pa]. # (n, 3)
        inner: steps in a sample.
    """
    e = g.concealed
    h = SAMPLE_S / inner
    k1, k2, k3, k4, mid = np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE)
    shaft = y[4] - y[9]
    lag = g.t_d + e.delay_s
    u = 0.0
    for n in range(len(out)):
        t = n * SAMPLE_S
        z = travelled(g, shaft)
        bowed = e.bow_rad * (1.0 - z * z) + worn(e, 0.5 * (z + 1.0))
        out[n, 0] = shaft + bowed + e.drift_rad_per_min * t / 60.0
        out[n, 1] = y[2]
        out[n, 2] = y[3]
        if closed:
            volts[n] = controlled(series[n] - out[n, 0] - noise[n], driving)
        elif n > 0 and series[n] == series[n - 1]:
            volts[n] = volts[n - 1]
        else:
            volts[n] = turned_back(series[n], out[n, 0], driving)
        for i in range(inner):
            now = t + i * h
            place = math.floor((now + 0.5 * h - lag) / SAMPLE_S)
            wanted = g.polarity * volts[int(place)] if place >= 0 and not lost(e, now - lag) else 0.0
            wanted = min(max(wanted, -g.limit), g.limit)
            u = min(max(wanted, u - e.ramp_v_per_s * h), u + e.ramp_v_per_s * h)
            rates(g, y, u, now, k1)
            for j in range(SIZE):
                mid[j] = y[j] + 0.5 * h * k1[j]
            rates(g, mid, u, now + 0.5 * h, k2)
            for j in range(SIZE):
                mid[j] = y[j] + 0.5 * h * k2[j]
            rates(g, mid, u, now + 0.5 * h, k3)
            for j in range(SIZE):
                mid[j] = y[j] + h * k3[j]
            rates(g, mid, u, now + h, k4)
            for j in range(SIZE):
                y[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])
            y[2] = max(y[2], 0.0)
            y[3] = max(y[3], 0.0)
            seen = y[4] - y[9]
            shaft = min(max(shaft, seen - e.play_rad), seen + e.play_rad)


class Player:
    """Runs machines of one kind."""

    def __init__(
        self,
        compiled: Callable[..., None],
        at_rest: Callable[[Any, float], np.ndarray],
        turns_back: bool,
    ) -> None:
        """Keep its equations.

        Args:
            compiled: `run` with the kind's rates and travel.
            at_rest: machine and angle [rad] -> state in balance. # (SIZE,)
            turns_back: whether voltages that would drive it into its stop are turned round.
        """
        self._compiled = compiled
        self._at_rest = at_rest
        self._turns_back = turns_back

    def __call__(
        self,
        machine: Any,
        driving: Driving,
        command: np.ndarray | None,
        set_points: np.ndarray | None = None,
        noise: np.ndarray | None = None,
        step: float = STEP_S,
    ) -> Played:
        """Run a machine from rest where it is driven from, by a voltage or by a controller that follows set points.

        Args:
            machine: its numbers.
            driving: start and controller.
            command: voltage every 10 ms; None for a controller. # (n,)
            set_points: for the controller [rad]. # (n,)
            noise: what the controller's measurement adds [rad]. # (n,)
            step: of the Runge-Kutta method [s].
        """
        series = command if command is not None else set_points
        assert series is not None
        count = len(series)
        volts, out = np.zeros(count), np.zeros((count, 3))
        self._compiled(
            machine,
            driving if self._turns_back else unhindered(driving),
            command is None,
            np.asarray(series, dtype=float),
            np.zeros(count) if noise is None else noise,
            self._at_rest(machine, math.radians(driving.start_deg)),
            volts,
            out,
            round(SAMPLE_S / step),
        )
        return Played(volts, out[:, 0], out[:, 1], out[:, 2])
