"""An accumulator on the pump's line: gas behind a bladder, which oil compresses."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.smooth import exponential, logarithm

STAGE = Stage(
    "accumulator",
    "gas accumulator on a pump's line, shared by all joints",
    (),
    {
        "none": (),
        "gas": (
            Parameter("volume", "m^3", "gas at its precharge", lowest=0.0, positive=True),
            Parameter("precharge", "Pa", "pressure of the gas without oil", lowest=0.0, positive=True),
            Parameter(
                "exponent",
                "1",
                "polytropic: 1 for slow (isothermal), 1.4 and more for fast (adiabatic) changes",
                lowest=1.0,
            ),
        ),
    },
    default="none",
)
NONE = float(STAGE.code("none"))


@njit
def gas_capacity(pressure: float, joint: Any) -> float:
    """Volume of oil that the accumulator takes for each pascal [m^3/Pa]; none below its precharge.

    p V^n = p_0 V_0^n, so that -dV/dp = V_0/(n p) (p_0/p)^(1/n), pressures absolute.

    Args:
        pressure: of the line [Pa].
        joint: parameter record.
    """
    p = joint.accumulator
    if pressure <= p.precharge:
        return 0.0
    atmosphere = joint.fluid.atmospheric_pressure
    now, first = pressure + atmosphere, p.precharge + atmosphere
    return p.volume / (p.exponent * now) * exponential(logarithm(first / now) / p.exponent)
