"""What is declared about each parameter of a rig: by its stage, its effect, or for the integration."""

from collections.abc import Mapping
from dataclasses import replace

from hydrolek_drake.effects.catalogue import effect_named
from hydrolek_drake.effects.effect import Effect
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.records import JOINT_STAGES, SHARED_STAGES

LONGEST_STEP = Parameter("longest_step", "s", "upper bound of the rollout's integration step", lowest=1e-6)
SPOOL_STEPS = Parameter(
    "spool_steps", "1", "steps of the spool within one step of the rest", lowest=1.0, highest=10_000.0
)

MODEL_ERROR = Parameter(
    "model_error",
    "1",
    "share of a signal's range that the equations leave at best, as what nobody described",
    neutral=0.0,
    lowest=0.0,
    highest=0.1,
)
TIME_ERROR = Parameter(
    "time_error",
    "s",
    "standard deviation of when a sample was taken, and of when the equations at best have something happen",
    neutral=0.0,
    lowest=0.0,
    highest=0.1,
)
SLIDING = {"rad": "m", "rad/min": "m/min", "N m/rad": "N/m", "N m s/rad": "N s/m", "kg m^2": "kg"}
"""Units that an effect declares for a joint that turns -> the same where its load slides."""

TURNING = {"N": "N m", "N s/m": "N m s/rad", "m/s": "rad/s", "m": "rad"}
"""Units that an effect declares for a rod or a slide -> the same at a shaft."""

SHAFTS = ("vane", "hydraulic_motor")
"""Actuators without a rod."""

OF_INTEGRATION = (LONGEST_STEP, SPOOL_STEPS, MODEL_ERROR, TIME_ERROR)


def declared(full_path: str, variants: Mapping[str, str]) -> Parameter:
    """Unit, meaning and bounds of a parameter.

    Args:
        full_path: of the parameter.
        variants: of a rig, see `rig.Rig`.
    """
    if full_path.startswith("integration."):
        return next(p for p in OF_INTEGRATION if p.name == full_path.partition(".")[2])
    section, _, name = full_path.rpartition(".")
    if ".effects." in section:
        effect = effect_named(section.split(".effects.")[1])
        joint = section.split(".effects.")[0]
        return at_joint(next(p for p in effect.parameters if p.name == name), effect, joint, variants)
    stage = {**SHARED_STAGES, **JOINT_STAGES}[section.split(".")[-1]]
    return next(p for p in stage.parameters(variants[section]) if p.name == name)


def unit_there(unit: str, effect: Effect, joint: str, variants: Mapping[str, str]) -> str:
    """The unit of an effect's parameter at a joint: of a length where the load slides, of an angle where it turns.

    Args:
        unit: that the effect declares.
        effect: whose.
        joint: `joints.<name>`.
        variants: of a rig, see `rig.Rig`.
    """
    if variants[f"{joint}.load"] == "sliding":
        return SLIDING.get(unit, unit)
    shaft = effect.stage == "cylinder" and variants[f"{joint}.cylinder"] in SHAFTS
    return TURNING.get(unit, unit) if shaft or effect.stage == "load" else unit


def at_joint(parameter: Parameter, effect: Effect, joint: str, variants: Mapping[str, str]) -> Parameter:
    """An effect's parameter as a rig file may state it at a joint: in its unit there, or the declared one.

    Arguments as of `unit_there`.
    """
    there = unit_there(parameter.unit, effect, joint, variants)
    return parameter if there == parameter.unit else replace(parameter, unit=f"{there}|{parameter.unit}")
