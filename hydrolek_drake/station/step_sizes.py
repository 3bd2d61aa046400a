"""How finely a diagram runs, and with which integrator."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.lines import hose
from hydrolek_drake.physics.lines.long_line import SEGMENTS
from hydrolek_drake.rigs import Rig

INTEGRATORS = {
    "runge_kutta3": "runge_kutta3",
    "runge_kutta2": "runge_kutta2",
    "symplectic_euler": "semi_explicit_euler",
}
"""How a diagram may be integrated -> Drake's name for it. With the actuators' forces one step ahead, Drake's
semi-explicit Euler is symplectic in pressure and velocity too."""


@dataclass(frozen=True)
class StepSizes:
    """How finely a diagram runs.

    Attributes:
        step: of the spools, the transport delay and the integrator [s].
        plant_step: of a discrete MultibodyPlant [s], as contact needs it; 0 for a continuous plant, which is
            more accurate.
        log_period: how often signals are written [s].
        integrator: one of `INTEGRATORS`. "runge_kutta3" bears oil springs that nothing damps, such as a wrist whose
            valves are closed while the arm is thrown about; "runge_kutta2" asks for two evaluations a step instead
            of three and feeds such a spring's oscillation; "symplectic_euler" asks for one and is of first order.
        mount_forces: whether cylinders push at their mounting points, as in the thesis (4.2.4), or act by
            force times lever on their joint, which is the same by virtual work and takes less time.
    """

    step: float = 1e-3
    plant_step: float = 0.0
    log_period: float = 1e-2
    integrator: str = "runge_kutta3"
    mount_forces: bool = True

    def __post_init__(self) -> None:
        """Refuse an integrator that the actuators are not built for."""
        if self.integrator not in INTEGRATORS:
            raise InputError(f"integrator '{self.integrator}' is unknown; use {' or '.join(INTEGRATORS)}")


WAVES_SEEN = 1.0
"""A step lasts at most so many radians of the fastest oscillation of a chain of segments, 2 c over a segment's length:
the third-order method is stable up to sqrt(3)."""


def sizes_for(rig: Rig) -> StepSizes:
    """Steps that a Diagram of a rig takes where none is given, logged at every one of them.

    With them it stays as near the rollout as a sensor's noise (docs/evidence/agreement.md). A rollout bears stiff
    frictions by
    an implicit method, a Diagram's explicit one needs steps that see them: two of the rollout's, and a quarter of that
    where a play closes, whose blows take 0.2 ms, or a relief valve sticks in its hysteresis, while nothing but the
    line's volume holds the pressure. Long lines need steps that see their fastest oscillation.
    """
    step = min(StepSizes.step, 2.0 * rig.value("integration.longest_step"))
    records = rig.records()
    sticks = any(bool(np.any(records["supply"][name] > 0.0)) for name in ("relief_hysteresis", "relief_time"))
    if sticks or any(hooks.linkage_gap(record) > 0.0 for record in records):
        step /= 4.0
    for record in records[records["hose"]["variant"] == hose.LONG_LINE]:
        shortest = min(float(record["hose"][name]) for name in ("length_a", "length_b"))
        step = min(step, WAVES_SEEN * 0.5 * shortest / (SEGMENTS * float(record["hose"]["wave_speed"])))
    return StepSizes(step=step, log_period=step)
