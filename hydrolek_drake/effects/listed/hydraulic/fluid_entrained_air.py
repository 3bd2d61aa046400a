"""Air in the oil: soft where the pressure is low."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.smooth import exponential, logarithm
from hydrolek_drake.physics.usual import rare

EFFECT = Effect(
    id="fluid.entrained_air",
    title="entrained air",
    equation="1/B_eff = 1/B + air_fraction p_atm / p^2, p at least p_atm; in a fluid of the variant polytropic_air "
    "1/B_eff = 1/B + air_fraction (p_atm/P)^(1/n) / (n P) with the absolute pressure P = p + p_atm",
    parameters=(
        Parameter(
            "air_fraction", "1", "volume share of air at atmospheric pressure", neutral=0.0, lowest=0.0
        ),
    ),
    formula=Formula(
        r"\frac{1}{B_\mathrm{eff}} = \frac{1}{B} + \frac{\alpha p_0}{p^2}",
        {"air_fraction": r"\alpha"},
        {"B": "bulk modulus of the oil", "p": "pressure", "p_0": "atmospheric pressure"},
    ),
    inspect=(
        "Look for foam or milky oil in the tank, its level, leaks of the suction line, and bleed the "
        "cylinders."
    ),
    size="air_fraction",
    beneath="some_air",
    search={
        "air_fraction": Search("air_fraction", 6, (0.1, 1.0)),
    },
    source="isothermal compression of free air: V_air = fraction p_atm / p, compressibility fraction p_atm / p^2; "
    "polytropic, P V^n = const: Gholizadeh, Burton, Schoenau, Fluid bulk modulus: a survey, IJFP 12 (2011) 5",
    confused_with={
        "base.compliance": "a soft base rings at a frequency that does not depend on the pressures",
    },
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("compressibility")
@njit
def compressibility(pressure: float, joint: Any) -> float:
    """Compressibility added to the oil's [1/Pa]."""
    fraction = joint.effects.fluid_entrained_air.air_fraction
    if fraction == 0.0:
        return 0.0
    atmosphere = joint.fluid.atmospheric_pressure
    if rare(joint) and joint.fluid.air_exponent >= 1.0:  # not a number but in its variant
        per_n, per_pressure = 1.0 / joint.fluid.air_exponent, 1.0 / (max(pressure, 0.0) + atmosphere)
        share = exponential(per_n * logarithm(atmosphere * per_pressure))
        return fraction * share * per_n * per_pressure
    absolute = max(pressure, atmosphere)
    return fraction * atmosphere / (absolute * absolute)
