"""The cylinder brakes itself at the end of retraction."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="cylinder.end_cushion",
    title="end cushion",
    equation="damping v (1 - s/length) against the rod while s < length and v < 0",
    parameters=(
        Parameter("damping_N_s_per_m", "N s/m", "damping at the very end", neutral=0.0, lowest=0.0),
        Parameter("length_m", "m", "stroke over which it acts", neutral=1.0, lowest=0.0, positive=True),
    ),
    formula=Formula(
        r"F = d v \left( 1 - \frac{s}{l} \right), \quad s < l, \; v < 0",
        {"damping_N_s_per_m": "d", "length_m": "l"},
        {"F": "force against the rod", "v": "speed of the rod", "s": "stroke"},
    ),
    inspect=(
        "Look at the cushion of the retracted end, its throttle screw and check valve, and at what the "
        "joint may run into there."
    ),
    size="damping_N_s_per_m",
    search={
        "damping_N_s_per_m": Search("damping", 4, (0.1, 0.5)),
        "length_m": Search("stroke", 0.5, (0.1, 0.3), lowest=0.01, beyond="nearest"),
    },
    source="cushioning spears of differential cylinders (Merritt 1967, ch. 6)",
    confused_with={
        "sensor.nonlinearity": "a bow of the sensor is largest in the middle of the travel, and shows at rest too",
    },
    needs={"cylinder": ("cylinder", "vane")},
)


@EFFECT.hook("rod_damping")
@njit
def rod_damping(velocity: float, stroke: float, joint: Any) -> tuple[float, float]:
    """Braking force [N] and its slope [N s/m]."""
    p = joint.effects.cylinder_end_cushion
    if p.damping_N_s_per_m == 0.0 or velocity >= 0.0 or stroke >= p.length_m:
        return 0.0, 0.0
    slope = p.damping_N_s_per_m * (1.0 - stroke / p.length_m)
    return slope * velocity, slope
