"""The variants of a directional valve and their parameters."""

from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.valves import flow_map, opening_table, pump_controlled

EDGES = ("pa", "at", "pb", "bt")
"""P-A and B-T open towards A, P-B and A-T towards B."""

_WAYS = {"pa": "from P to A", "at": "from A to the tank", "pb": "from P to B", "bt": "from B to the tank"}

STAGE = Stage(
    "valve",
    "spool position to oil flow",
    (),
    {
        "plain": (
            Parameter("overlap_a", "m", "spool travel before P opens to A", lowest=0.0),
            Parameter("overlap_b", "m", "spool travel before P opens to B", lowest=0.0),
            Parameter(
                "full_opening_a", "m", "spool travel of the largest opening towards A, w in (4.7)", lowest=0.0
            ),
            Parameter(
                "full_opening_b", "m", "spool travel of the largest opening towards B, w in (4.7)", lowest=0.0
            ),
            Parameter("max_area_a", "m^2", "largest orifice area when A is fed, A_max in (4.7)", lowest=0.0),
            Parameter("max_area_b", "m^2", "largest orifice area when B is fed, A_max in (4.7)", lowest=0.0),
            Parameter("discharge", "1", "contraction coefficient C_q in (4.7)", lowest=0.0),
            Parameter(
                "flow_force",
                "1",
                "share of opening area times pressure drop with which oil closes the spool; 0 where compensated",
                neutral=0.0,
                lowest=0.0,
            ),
        ),
        "pressure_compensated": (
            Parameter("overlap_a", "m", "spool travel before P opens to A", lowest=0.0),
            Parameter("overlap_b", "m", "spool travel before P opens to B", lowest=0.0),
            Parameter("full_opening_a", "m", "spool travel of full flow towards A", lowest=0.0),
            Parameter("full_opening_b", "m", "spool travel of full flow towards B", lowest=0.0),
            Parameter("full_flow", "m^3/s", "metered-in flow at full opening", lowest=0.0),
            Parameter("compensator_pressure", "Pa", "pressure drop that the compensator needs", lowest=0.0),
            Parameter(
                "return_coefficient",
                "m^3/(s Pa^0.5)",
                "metering-out flow over root of pressure drop",
                lowest=0.0,
            ),
        ),
        "none": (),
        "four_edges": (
            Parameter(
                "full_opening",
                "m",
                "spool travel at which every edge is open widest",
                lowest=0.0,
                positive=True,
            ),
            *(
                Parameter(
                    f"overlap_{edge}",
                    "m",
                    f"spool travel before the edge {way} opens; below zero for an underlap",
                )
                for edge, way in _WAYS.items()
            ),
            *(
                Parameter(
                    f"area_gradient_{edge}",
                    "m^2/m",
                    f"area that the edge {way} opens per travel: the width of its ports",
                    lowest=0.0,
                )
                for edge, way in _WAYS.items()
            ),
            Parameter("discharge", "1", "contraction coefficient C_q in (4.7)", lowest=0.0),
            Parameter(
                "edge_rounding",
                "m",
                "radius of the spool's edges: within it an edge opens by less than its travel",
                neutral=0.0,
                lowest=0.0,
            ),
            *opening_table.parameters(_WAYS),
        ),
        "flow_map": (
            Parameter("overlap_a", "m", "spool travel before P opens to A", lowest=0.0),
            Parameter("overlap_b", "m", "spool travel before P opens to B", lowest=0.0),
            *flow_map.PARAMETERS,
        ),
        "pump_controlled": pump_controlled.PARAMETERS,
    },
)
PLAIN = float(STAGE.code("plain"))
PRESSURE_COMPENSATED = float(STAGE.code("pressure_compensated"))
NO_VALVE = float(STAGE.code("none"))
FOUR_EDGES = float(STAGE.code("four_edges"))
FLOW_MAP = float(STAGE.code("flow_map"))
PUMP_CONTROLLED = float(STAGE.code("pump_controlled"))
