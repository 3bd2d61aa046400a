"""Numbers of foreign machines, and machines that have them."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from hydrolek_drake.challenge.foreign.equations import GRAVITY
from hydrolek_drake.challenge.foreign.plant import Plant
from hydrolek_drake.yaml_files import package_yaml


def numbers() -> dict[str, Any]:
    """Of `machines.yaml`."""
    found: dict[str, Any] = package_yaml(__package__, "machines.yaml")
    return found


def built(own: Mapping[str, Any], kind: str, rng: np.random.Generator) -> tuple[dict[str, Any], Plant]:
    """A kind's numbers as drawn, and the machine that has them."""
    common, base = own["common"], {"kind": kind, **own["kinds"][kind]}

    def spread(value: float, by: float = own["spread"]) -> float:
        return float(value * by ** rng.uniform(-1.0, 1.0))

    for key in ("mass_kg", "damping", "seal_damping", "overlap", "bandwidth_hz"):
        base[key] = spread(base[key])
    flow = spread(1.0)
    base["rated_flow_l_min"] = [flow * each for each in base["rated_flow_l_min"]]
    base["supply_bar"] = spread(base["supply_bar"], own["supply_spread"])
    base["displacement_cm3"] *= flow
    for key in ("spool_damping", "delay_ms", "dead_share", "bulk_GPa", "relief_rise", "line_l"):
        base[key] = spread(common[key])
    return base, _plant(own, base, rng)


def _plant(own: Mapping[str, Any], base: Mapping[str, Any], rng: np.random.Generator) -> Plant:
    common = own["common"]
    area_a = 0.25 * math.pi * (1e-3 * base["bore_mm"]) ** 2
    area_b = area_a - 0.25 * math.pi * (1e-3 * base["rod_mm"]) ** 2
    stroke = 1e-3 * base["stroke_mm"]
    turns = base["moves"] == "link"
    (bx, by), (lx, ly) = base["base_mount_m"], base["link_mount_m"]
    travel = 1e-3 * common["spool_travel_mm"]
    overlap = base["overlap"] * travel
    jet = math.sqrt(2.0 * 1e5 * common["rated_drop_bar"] / common["density"])
    open_by = common["flow_coefficient"] * jet * (travel - overlap)
    width = tuple(each / 6e4 / open_by for each in base["rated_flow_l_min"])
    dead = base["dead_share"] * area_a * stroke
    differs = 1.0 + common["dead_volume_differs"] * rng.uniform(-1.0, 1.0)
    setting = 1e5 * base["supply_bar"]
    pump = 1e-6 * base["displacement_cm3"] * common["pump_rpm"] / 60.0
    inertia = base["mass_kg"] * (base["length_m"] ** 2 / 3.0 if turns else 1.0)
    link_r, phase, retracted, lever = 1.0, 0.0, 0.0, 1.0
    if turns:
        link_r, phase = math.hypot(lx, ly), math.atan2(ly, lx)
        at = math.radians(base["mid_stroke_at_deg"]) + phase
        rod_x, rod_y = link_r * math.cos(at) - bx, link_r * math.sin(at) - by
        length = math.hypot(rod_x, rod_y)
        retracted = length - 0.5 * stroke
        lever = (link_r * math.cos(at) * rod_y - link_r * math.sin(at) * rod_x) / length
    force = area_a * setting
    gap = own["effects"]["linkage.backlash"]["gap"]
    weighs = turns and not base["upright"]
    return Plant(
        turns=float(turns),
        area_a=area_a,
        area_b=area_b,
        stroke=stroke,
        retracted=retracted,
        base_x=bx,
        base_y=by,
        link_r=link_r,
        link_phase=phase,
        dead_a=dead,
        dead_b=dead * differs,
        inertia=inertia,
        weight_moment=base["mass_kg"] * GRAVITY * 0.5 * base["length_m"] if weighs else 0.0,
        damping=base["damping"],
        seal_damping=base["seal_damping"],
        width=width,
        overlap=overlap,
        rounding=1e-6 * common["clearance_um"],
        travel=travel,
        natural=2.0 * math.pi * base["bandwidth_hz"],
        ratio=base["spool_damping"],
        full_volts=common["full_command_V"],
        delay=1e-3 * base["delay_ms"],
        discharge=common["flow_coefficient"],
        density=common["density"],
        viscosity=1e-6 * common["viscosity_mm2_s"],
        critical=common["critical_flow_number"],
        bulk=1e9 * base["bulk_GPa"],
        tank=1e5 * common["tank_bar"],
        pumped=float(base["supply"] == "pump"),
        setting=setting,
        pump=pump,
        pump_leak=common["pump_leakage"] * pump / setting,
        rise=base["relief_rise"] * setting,
        relief_s=1e-3 * common["relief_ms"],
        line=1e-3 * base["line_l"],
        droop_s=common["droop_s"],
        stop=force / (1e-3 * common["stop_depth_mm"]) ** 1.5,
        stop_damping=common["stop_damping_s_m"],
        bristle=1e6 / common["bristle_um"],
        coupling=common["coupling_share"] * inertia,
        contact=force * lever / (common["coupling_depth"] * gap * stroke / lever) ** 1.5,
        gas_exponent=common["gas_exponent"],
        tip=base["length_m"],
        stribeck=common["stribeck_m_s"],
    )


def start_of(base: Mapping[str, Any]) -> float:
    """Where a machine rests first [rad or m]: at half of its stroke."""
    if base["moves"] == "link":
        return math.radians(base["mid_stroke_at_deg"])
    return 0.5e-3 * float(base["stroke_mm"])


def noises(own: Mapping[str, Any], turns: bool) -> tuple[float, float]:
    """Standard deviations of the position's noise [rad or m] and of the pressures' [Pa]."""
    common = own["common"]
    place = math.radians(common["angle_noise_deg"]) if turns else 1e-3 * common["position_noise_mm"]
    return place, 1e3 * common["pressure_noise_kPa"]


def places(plant: Plant, shares: tuple[float, ...] | list[float]) -> list[float]:
    """Angles or places where the piston stands at shares of its stroke; levers keep their sign."""
    if plant.turns < 0.5:
        return [share * plant.stroke for share in shares]
    found = []
    for share in shares:
        length = plant.retracted + share * plant.stroke
        base = math.hypot(plant.base_x, plant.base_y)
        cosine = (base**2 + plant.link_r**2 - length**2) / (2.0 * base * plant.link_r)
        towards = math.atan2(plant.base_y, plant.base_x)
        found.append(math.remainder(math.acos(cosine) + towards - plant.link_phase, 2.0 * math.pi))
    return found
