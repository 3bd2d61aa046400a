"""Long lines between a joint's valve and its chambers, ahead of the rest of a step.

A step of the lines foretells the chambers' pressures with the rod's speed held, and solves lines and chambers together,
so that short lines and small chambers do not shorten steps. What the chambers are fed meanwhile, in the mean, is what
the rest of the step takes.
"""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import cavity, cylinder, fluid, linkage, valve
from hydrolek_drake.physics.driven import is_followed, pressure_at_valves, pressure_told
from hydrolek_drake.physics.lines.long_line import (
    Ended,
    Fed,
    Lines,
    Pipe,
    Source,
    line_rates,
    moved,
    pipes,
    stage,
    without_cavities,
)
from hydrolek_drake.physics.probes import Probe
from hydrolek_drake.physics.solenoid import GAMMA
from hydrolek_drake.physics.valves.openings import openings, widened
from hydrolek_drake.rollout.rates import State, rod_side


@njit
def fed_now(lines: Lines, s: State, x: float, time: float, outside: Probe, probe: Probe, joint: Any) -> Fed:
    """What the chambers are fed at one moment.

    Args:
        lines: where they are.
        s: the rest of the state.
        x: spool position [m].
        time: since switching on [s].
        outside: inputs from outside.
        probe: the same with what a law adds.
        joint: parameter record.
    """
    _, _, drawn = _sources(lines.a.p_0, lines.b.p_0, s, x, time, outside, probe, joint)
    return Fed(lines.a.q_4, lines.b.q_4, drawn)


@njit
def _sources(
    p_a: float, p_b: float, s: State, x: float, time: float, outside: Probe, probe: Probe, joint: Any
) -> tuple[Source, Source, float]:
    p_supply = pressure_at_valves(s.supply, outside, probe, joint)
    opened = widened(openings(x, joint), probe.valve)
    at_a, at_b, drawn = valve.port_sources(
        opened, p_supply, p_a, p_b, time, joint, probe.back_a, probe.back_b
    )
    if is_followed(joint):
        own = pressure_told(s.supply, p_supply, outside, probe, joint)
        _, _, drawn = valve.port_sources(opened, own, p_a, p_b, time, joint)
    return at_a, at_b, drawn


@njit
def lines_advanced(
    lines: Lines, s: State, x: float, time: float, h: float, outside: Probe, probe: Probe, joint: Any
) -> tuple[Lines, Fed]:
    """The lines after a step, and what they feed the chambers in its mean.

    Args:
        lines: where they are.
        s: the rest of the state.
        x: mean position of the spool over the step [m].
        time: since switching on [s].
        h: step [s], more than none.
        outside: inputs from outside.
        probe: the same with what a law adds.
        joint: parameter record.
    """
    q, w = rod_side(s, joint)
    stroke, lever = linkage.stroke_and_lever(q, joint)
    v = lever * w
    _, _, stiff_a, stiff_b = cylinder.pressure_rates(s.p_a, s.p_b, 0.0, 0.0, stroke, v, joint)
    _, stiff_a = fluid.softened(probe.capacity_a, 0.0, stiff_a)
    _, stiff_b = fluid.softened(probe.capacity_b, 0.0, stiff_b)
    of_a, of_b = pipes(joint)
    taken_a, taken_b = joint.cylinder.area_a * v, -joint.cylinder.area_b * v
    p_a, p_b = cavity.pressures(s.p_a, s.p_b, joint)
    a, b = Ended(lines.a, p_a), Ended(lines.b, p_b)
    source_a, source_b, drawn = _sources(lines.a.p_0, lines.b.p_0, s, x, time, outside, probe, joint)
    part, open_a, open_b = GAMMA * h, source_a.conductance, source_b.conductance
    k_a = stage(lines.a, _rates(a, source_a, taken_a, stiff_a, of_a), open_a, 1.0 / stiff_a, part, of_a)
    k_b = stage(lines.b, _rates(b, source_b, taken_b, stiff_b, of_b), open_b, 1.0 / stiff_b, part, of_b)
    next_a, next_b = moved(a, k_a, h), moved(b, k_b, h)
    source_a, source_b, later = _sources(
        max(next_a.line.p_0, 0.0), max(next_b.line.p_0, 0.0), s, x, time + h, outside, probe, joint
    )
    m_a = moved(_rates(next_a, source_a, taken_a, stiff_a, of_a), k_a, -2.0)
    m_b = moved(_rates(next_b, source_b, taken_b, stiff_b, of_b), k_b, -2.0)
    m_a = stage(lines.a, m_a, open_a, 1.0 / stiff_a, part, of_a)
    m_b = stage(lines.b, m_b, open_b, 1.0 / stiff_b, part, of_b)
    end_a, end_b = moved(moved(a, k_a, 1.5 * h), m_a, 0.5 * h), moved(moved(b, k_b, 1.5 * h), m_b, 0.5 * h)
    return (
        Lines(without_cavities(end_a.line), without_cavities(end_b.line)),
        Fed(
            (end_a.p_end - p_a) / (h * stiff_a) + taken_a,
            (end_b.p_end - p_b) / (h * stiff_b) + taken_b,
            0.5 * (drawn + later),
        ),
    )


@njit
def _rates(at: Ended, source: Source, taken: float, stiffness: float, of: Pipe) -> Ended:
    """Rates of a line and its chamber, of which the piston takes a flow [m^3/s]."""
    return Ended(line_rates(at.line, source, at.p_end, of), stiffness * (at.line.q_4 - taken))
