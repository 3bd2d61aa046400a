"""Checks of a rig's valves."""

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.cylinder import ELECTRIC
from hydrolek_drake.physics.valves import flow_map
from hydrolek_drake.physics.valves.variants import EDGES
from hydrolek_drake.rigs.checks.checked import Checked


def check(rig: Checked, where: str) -> None:
    """Refuse a valve that never opens.

    Raises:
        InputError: an overlap as long as the travel, a flow map whose pressure drops or flows do not rise, what stands
            in series with nothing, or pulses that shorten with the command.
    """
    variant = rig.variants[f"{where}.valve"]
    _check_what_stands_in_series(rig, where, variant)
    _check_pulses(rig, where)
    _check_switching(rig, where)
    if variant in ("none", "pump_controlled"):
        return
    overlaps, full = {"four_edges": (EDGES, "full_opening"), "flow_map": (("a", "b"), "full_travel")}.get(
        variant, (("a", "b"), "")
    )
    for side in overlaps:
        name = full or f"full_opening_{side}"
        overlap, travel = (rig.value(f"{where}.valve.{key}") for key in (f"overlap_{side}", name))
        if not overlap < travel:
            raise InputError(
                f"{rig.path}: {where}.valve: {name} ({travel:g} m) must be larger than "
                f"overlap_{side} ({overlap:g} m)"
            )
    if variant == "flow_map":
        for side in "ab":
            for opening in flow_map.OPENINGS:
                names = [f"flow_{side}_{opening}_{drop}" for drop in flow_map.DROPS]
                flows = [rig.value(f"{where}.valve.{name}") for name in names]
                if not flows[0] <= flows[1] <= flows[2]:
                    raise InputError(
                        f"{rig.path}: {where}.valve: {', '.join(names)} fall with the pressure drop: "
                        f"{', '.join(f'{flow:g}' for flow in flows)} m^3/s"
                    )
        drops = [rig.value(f"{where}.valve.drop_{drop}") for drop in flow_map.DROPS]
        if not drops[0] < drops[1] < drops[2]:
            raise InputError(
                f"{rig.path}: {where}.valve: drop_low, drop_middle, drop_high must rise, not "
                f"{', '.join(f'{drop:g}' for drop in drops)} Pa"
            )


def _check_long_lines(rig: Checked, where: str, variant: str) -> None:
    """Long lines lead from a valve's edges to the chambers, and nothing stands between them and these."""
    if variant in ("none", "pump_controlled"):
        raise InputError(
            f"{rig.path}: {where}.hose: long lines lead from a valve's edges, which a valve of variant {variant} has "
            "not; use variant: none"
        )
    if rig.variants[f"{where}.holding"] != "none":
        raise InputError(
            f"{rig.path}: {where}.hose: a holding valve behind a long line is not modelled; use variant: hose, or "
            "holding: {variant: none}"
        )


def _check_what_stands_in_series(rig: Checked, where: str, variant: str) -> None:
    """Hoses and holding valves need a valve's edges to stand in series with, and oil."""
    for stage in ("holding", "hose"):
        if rig.variants[f"{where}.{stage}"] == "none":
            continue
        if stage == "hose" and rig.variants[f"{where}.hose"] == "long_line":
            _check_long_lines(rig, where, variant)
        if rig.variants[f"{where}.cylinder"] in ELECTRIC:
            raise InputError(
                f"{rig.path}: {where}.{stage}: an electric actuator has no oil; use variant: none"
            )
        losses = (
            [f"{name}_{side}" for name in ("resistance", "loss") for side in "ab"]
            if rig.variants[f"{where}.{stage}"] == "hose"
            else []
        )
        lossy = [name for name in losses if rig.value(f"{where}.hose.{name}") > 0.0]
        if variant == "pump_controlled" and (stage == "holding" or lossy):
            what = "a holding valve" if stage == "holding" else f"{lossy[0]}"
            raise InputError(
                f"{rig.path}: {where}.{stage}: {what} would act on no flow, since a pump_controlled actuator has no "
                "valve's edges to stand in series with"
            )
    if rig.variants[f"{where}.holding"] != "none":
        ports = [rig.value(f"{where}.holding.at_{port}") for port in "ab"]
        if any(port not in (0.0, 1.0) for port in ports) or not any(ports):
            raise InputError(
                f"{rig.path}: {where}.holding: at_a {ports[0]:g} and at_b {ports[1]:g} must be 0 or 1, one of them 1; "
                "without any use variant: none"
            )


def _check_switching(rig: Checked, where: str) -> None:
    """A switching valve is switched by the command's voltage."""
    if rig.variants[f"{where}.solenoid"] != "switching":
        return
    amplifier = rig.variants[f"{where}.amplifier"]
    if amplifier != "none":
        raise InputError(
            f"{rig.path}: {where}.solenoid: a switching valve has no amplifier of variant {amplifier}; use "
            "amplifier: {variant: none}"
        )
    threshold, limit = rig.value(f"{where}.solenoid.threshold"), rig.value(f"{where}.command.limit")
    if not threshold <= limit:
        raise InputError(
            f"{rig.path}: {where}.solenoid: threshold ({threshold:g} V) lies beyond command.limit ({limit:g} V): the "
            "valve would never switch"
        )


def _check_pulses(rig: Checked, where: str) -> None:
    if rig.variants[f"{where}.amplifier"] != "pwm":
        return
    least, most = (rig.value(f"{where}.amplifier.{name}_duty") for name in ("least", "most"))
    if not least < most:
        raise InputError(
            f"{rig.path}: {where}.amplifier: least_duty {least:g} must lie below most_duty {most:g}"
        )
