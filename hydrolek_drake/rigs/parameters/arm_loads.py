"""The loads of a joint that follow from the arms' geometry and the posture of the other joints."""

import functools

from hydrolek_drake.rigs.parameters.entries import Entry

FROM_ARM = (
    "inertia",
    "gravity_cos",
    "gravity_sin",
    "payload_inertia",
    "payload_gravity_cos",
    "payload_gravity_sin",
)


def arm_entries() -> dict[str, Entry]:
    """Placeholders for what `Rig.value` asks of the MultibodyPlant when it is needed."""
    return {
        name: Entry(float("nan"), "", "from urdf/hydrolek.urdf with the other joints held")
        for name in FROM_ARM
    }


@functools.cache
def arm_load(joint: str, held: tuple[tuple[str, float], ...]) -> dict[str, float]:
    """`FROM_ARM` values of one joint at a posture of the others."""
    from hydrolek_drake.kinematics.arms import load_of_joint  # loads Drake, which SI-only rigs never need

    load = load_of_joint(joint, dict(held))
    values = (
        load.inertia,
        load.gravity_cos,
        load.gravity_sin,
        load.inertia_per_kg,
        load.gravity_cos_per_kg,
        load.gravity_sin_per_kg,
    )
    return dict(zip(FROM_ARM, values, strict=True))
