"""Data sheets of foreign machines, as wrong as those are."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

ERRING = (
    "mass",
    "length",
    "damping",
    "seal_damping",
    "rated_flow",
    "overlap",
    "bandwidth",
    "spool_damping",
    "delay",
    "dead_volume",
    "bulk_modulus",
    "supply_pressure",
)
PUMPS = ("displacement", "relief_rise", "line_volume")
"""What a data sheet may be wrong about; the latter where there is a pump."""


def data_sheet(
    own: Mapping[str, Any], base: Mapping[str, Any], rng: np.random.Generator
) -> tuple[dict[str, str], dict[str, float]]:
    """What the data sheet says, as options of `hydrolek rig new`, and by what it is wrong."""
    common, turns, pump = own["common"], base["moves"] == "link", base["supply"] == "pump"
    erring = [key for key in ERRING + PUMPS * pump if turns or key != "length"]
    by = own["sheet"]
    known = {"supply_pressure": by["pressure_wrong_by"], "displacement": by["displacement_wrong_by"]}
    wrong = {key: float(known.get(key, by["wrong_by"]) ** rng.uniform(-1, 1)) for key in erring}
    measured = {*known, "length"}  # by a gauge, by its maker, by a ruler
    one = str(rng.choice([key for key in erring if key not in measured]))
    wrong[one] = float(by["wrong_one"] ** rng.choice([-1.0, 1.0]))
    stroke = base["stroke_mm"]
    dead = base["dead_share"] * 0.25 * math.pi * base["bore_mm"] ** 2 * stroke / 1e3
    told: dict[str, str] = {
        "moves": base["moves"],
        "bore": f"{base['bore_mm']} mm",
        "rod": f"{base['rod_mm']} mm",
        "stroke": f"{stroke} mm",
        "mass": f"{wrong['mass'] * base['mass_kg']:.4g} kg",
        "seal_damping": f"{wrong['seal_damping'] * base['seal_damping']:.4g} N s/m",
        "rated_flow": " ".join(f"{wrong['rated_flow'] * each:.4g}" for each in base["rated_flow_l_min"]),
        "rated_drop": f"{common['rated_drop_bar']} bar",
        "spool_travel": f"{common['spool_travel_mm']} mm",
        "overlap": f"{wrong['overlap'] * base['overlap'] * common['spool_travel_mm']:.4g} mm",
        "bandwidth": f"{wrong['bandwidth'] * base['bandwidth_hz']:.4g} Hz",
        "spool_damping": f"{wrong['spool_damping'] * base['spool_damping']:.4g}",
        "delay": f"{wrong['delay'] * base['delay_ms']:.4g} ms",
        "dead_volume": f"{wrong['dead_volume'] * dead:.4g} cm^3",
        "bulk_modulus": f"{wrong['bulk_modulus'] * base['bulk_GPa']:.4g} GPa",
        "full_command": f"{common['full_command_V']} V",
        "supply": base["supply"],
        "supply_pressure": f"{wrong['supply_pressure'] * base['supply_bar']:.4g} bar",
        "tank_pressure": f"{common['tank_bar']} bar",
        "oil_density": f"{common['density']} kg/m^3",
        "pressure_noise": f"{common['pressure_noise_kPa']} kPa",
    }
    if turns:
        told |= {
            "base_mount": ", ".join(str(each) for each in base["base_mount_m"]) + " m",
            "link_mount": ", ".join(str(each) for each in base["link_mount_m"]) + " m",
            "mid_stroke_at": f"{base['mid_stroke_at_deg']} deg",
            "length": f"{wrong['length'] * base['length_m']:.4g} m",
            "upright": "yes" if base["upright"] else "no",
            "bearing_damping": f"{wrong['damping'] * base['damping']:.4g} N m s/rad",
            "angle_noise": f"{common['angle_noise_deg']} deg",
        }
    else:
        told |= {
            "guide_damping": f"{wrong['damping'] * base['damping']:.4g} N s/m",
            "position_noise": f"{common['position_noise_mm']} mm",
        }
    if pump:
        rise = wrong["relief_rise"] * base["relief_rise"] * base["supply_bar"]
        told |= {
            "displacement": f"{wrong['displacement'] * base['displacement_cm3']:.4g} cm^3/rev",
            "pump_speed": f"{common['pump_rpm']} rpm",
            "relief_rise": f"{rise:.4g} bar",
            "line_volume": f"{wrong['line_volume'] * base['line_l']:.4g} l",
        }
    return told, wrong
