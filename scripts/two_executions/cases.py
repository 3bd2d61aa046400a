"""Cases, a joint with an effect each, and the rigs on which they run: a body of its own, or the arms."""

import json
import tempfile
from pathlib import Path

import numpy as np
from pydrake.multibody.tree import UniformGravityFieldElement

from hydrolek_drake.physics import load
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rigs.machine.rig import Rig
from hydrolek_drake.rigs.parameters.arm_loads import FROM_ARM
from hydrolek_drake.rigs.reading.tree import rig_from_tree

Case = tuple[str, str | None]
"""Rig of one joint, and the effect that is on there."""

JOINTS = [f"hydrolek_{side}_j{number}" for side in ("right", "left") for number in range(1, 6)]
GRAVITY = UniformGravityFieldElement.kDefaultStrength  # m/s^2, of Drake and of the arms
ROUNDING = 1e-9  # N m per kg m^2, of a gravity moment
SIZES = Path(__file__).parents[1] / "agreement_effects.json"
BLOWS = "linkage.backlash"
"""Each closing of a play is a blow of a small inertia on a stiff spring, which takes 0.2 ms."""

RUBBING_BESIDE = {
    "cylinder.friction_asymmetry": "cylinder.coulomb_friction",
    "load.friction_asymmetry": "load.coulomb_friction",
}
"""What differs between the directions is a part of a friction. Alone it pushes in one of them, and feeds what rings
until a hair's breadth decides."""

BOUNCES = ("hydrolek_left_j4", BLOWS)
"""A light joint, a vane: it bounces where a hair's breadth decides, and both executions are of first order there."""


def share_of_step(case: tuple[str, str | None]) -> float:
    """Share of the step at which a case runs."""
    if case == BOUNCES:
        return 1.0 / 16.0
    return 0.25 if case[1] == BLOWS else 1.0


def with_effect(rig: Rig, effect: str | None, joint: int = 0) -> Rig:
    """The rig with one effect on at one joint, at a size that is plainly visible, relative to the rig's own numbers."""
    if effect is None:
        return rig
    if effect in RUBBING_BESIDE:
        rig = with_effect(rig, RUBBING_BESIDE[effect], joint)
    sizes = json.loads(SIZES.read_text())[effect]
    record = rig.records()[joint]
    scale = {
        "force": float(record["cylinder"]["area_a"] * record["supply"]["pressure"]),
        "inertia": float(record["load"]["inertia"]),
        "friction": float(record["cylinder"]["viscous_friction"]),
        "stroke": float(record["cylinder"]["stroke"]),
    }
    where = f"joints.{rig.joints[joint]}.effects.{effect}"
    return rig.with_values(
        {f"{where}.{name}": value * scale.get(of, 1.0) for name, (value, of) in sizes.items()}
    )


def single(case: Case) -> Rig:
    """The rig of one case."""
    joint, effect = case
    return with_effect(load_rig(joint), effect)


def fits_one_body(case: Case) -> bool:
    """Whether a case may share a diagram of single bodies: not the pump's effects, and no payload out of its plane."""
    values = single(case).records()[0]["load"]
    moment = np.hypot(values["payload_gravity_cos"], values["payload_gravity_sin"])
    swings_upright = np.isclose(moment, GRAVITY * np.sqrt(values["payload_inertia"]), rtol=1e-3)
    effect = case[1] or ""
    return not effect.startswith("supply.") and (effect != "load.payload" or bool(swings_upright))


def bodies(cases: list[Case]) -> Rig:
    """A rig with one body a case; nothing but a pump of constant pressure is shared."""
    joints, common = {}, {}
    for number, case in enumerate(cases):
        rig = single(case)
        tree = rig.as_tree()
        common = {key: tree[key] for key in ("schema", "integration", "recording", "supply", "fluid")}
        [name] = rig.joints
        sections = tree["joints"][name]
        values = rig.records()[0]["load"]
        turning = {
            p.name: {"value": float(values[p.name]), "unit": p.unit, "source": "the arms, other joints held"}
            for p in load.STAGE.parameters("rotating")
            if p.name in FROM_ARM
        }
        if np.hypot(values["gravity_cos"], values["gravity_sin"]) < ROUNDING * values["inertia"]:
            for key in ("gravity_cos", "gravity_sin"):  # of an upright axis: no body has so small a moment
                turning[key]["value"] = 0.0
        sections["load"] = {**sections["load"], **turning, "variant": "rotating"}
        joints[f"case_{number}"] = sections
    return rig_from_tree({**common, "name": "agreement", "joints": joints}, Path("agreement"))


def parted(cases: list[Case]) -> list[list[Case]]:
    """Those of the cases that may share a diagram of single bodies, by its step."""
    fit = [case for case in cases if fits_one_body(case)]
    shares = dict.fromkeys(share_of_step(case) for case in fit)
    return [[case for case in fit if share_of_step(case) == share] for share in shares]


def on_the_arms(cases: list[Case]) -> Rig:
    """A rig of the arms that moves the joints of these cases; the others are held."""
    names = [joint.removeprefix("hydrolek_") for joint, _ in cases]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rig.yaml"
        path.write_text(f"schema: 1\nname: agreement\nbased_on: hydrolek\nkeep: [{', '.join(names)}]\n")
        rig = load_rig(path)
    for number, (_, effect) in enumerate(cases):
        rig = with_effect(rig, effect, number)
    return rig
