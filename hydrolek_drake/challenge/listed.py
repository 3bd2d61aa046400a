"""Listed effects of a concealed machine: which field of `Concealed` each parameter is."""

from collections.abc import Mapping
from typing import Any

LISTED: dict[str, dict[str, str]] = {
    "command.delay": {"delay_s": "delay_s"},
    "amplifier.gain_fade": {"fraction": "fade", "time_constant_s": "fade_s"},
    "valve.asymmetric_overlap": {"shift_m": "shift_m"},
    "valve.spool_stiction": {"force_N": "stiction_n"},
    "valve.null_leakage": {"conductance_m3_per_s_Pa": "null_leak"},
    "supply.pressure_droop": {"resistance_Pa_s_per_m3": "droop"},
    "fluid.entrained_air": {"air_fraction": "air"},
    "fluid.warm_up": {"fraction": "warm", "time_constant_s": "warm_s"},
    "cylinder.cross_port_leakage": {"conductance_m3_per_s_Pa": "cross_leak"},
    "cylinder.coulomb_friction": {"coulomb_N": "coulomb_n"},
    "cylinder.stribeck_friction": {
        "coulomb_N": "coulomb_n", "stribeck_N": "stribeck_n", "stribeck_velocity_m_per_s": "stribeck_v",
    },
    "cylinder.end_cushion": {"damping_N_s_per_m": "cushion", "length_m": "cushion_m"},
    "linkage.backlash": {"gap_rad": "gap_rad"},
    "base.compliance": {"stiffness_Nm_per_rad": "base_k", "inertia_kg_m2": "base_j"},
    "load.payload": {"mass_kg": "payload_kg", "time_s": "payload_s"},
    "sensor.nonlinearity": {"amplitude_rad": "bow_rad"},
    "sensor.hysteresis": {"half_width_rad": "play_rad"},
    "sensor.drift": {"rate_rad_per_min": "drift_rad_per_min"},
}  # fmt: skip
"""Effect -> its parameters -> field of `Concealed`."""


def with_effects(machine: Any, effects: Mapping[str, Mapping[str, float]]) -> Any:
    """The machine, a named tuple of its numbers, with listed effects as they stand in labels and reports."""
    fields: dict[str, float] = {}
    for effect, parameters in effects.items():
        for name, value in parameters.items():
            fields[LISTED[effect][name]] = value
    return machine._replace(concealed=machine.concealed._replace(**fields))
