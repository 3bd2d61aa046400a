"""What is declared about each parameter of a rig: by its stage, its effect, or for the integration."""

from collections.abc import Mapping

from hydrolek_drake.effects.catalogue import effect_named
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
        return next(p for p in effect.parameters if p.name == name)
    stage = {**SHARED_STAGES, **JOINT_STAGES}[section.split(".")[-1]]
    return next(p for p in stage.parameters(variants[section]) if p.name == name)
