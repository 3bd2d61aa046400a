"""A long line between a port of the valve and its chamber, in which pressure waves run to and fro.

A line of length L, in which waves run at c, is a chain of `SEGMENTS` pi-segments: the oil of each is a mass between two
halves of its volume that give way (Merritt, Hydraulic Control Systems (1967), section 3.5; Watton, Fundamentals of
Fluid Power Control (2009), section 5.6). Per length it gives way by A/(rho c^2) and is as inert as rho/A. With four
segments the waves of a line that is closed at its end, (2 k - 1) c/(4 L), are 0.6 % too slow for k = 1, 6 % for k = 2.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.smooth import exponential, logarithm

SEGMENTS = 4

_SIDES = {"a": "port A", "b": "port B"}
PARAMETERS = (
    *(
        parameter
        for side, port in _SIDES.items()
        for parameter in (
            Parameter(f"length_{side}", "m", f"of the line of {port}", lowest=0.0, positive=True),
            Parameter(
                f"bore_{side}", "m", f"inner diameter of the line of {port}", lowest=0.0, positive=True
            ),
            Parameter(
                f"loss_{side}",
                "Pa s^2/m^6",
                f"pressure loss over squared flow of bends and fittings in the line of {port}",
                neutral=0.0,
                lowest=0.0,
            ),
        )
    ),
    Parameter(
        "wave_speed",
        "m/s",
        "of pressure waves, sqrt(B/rho) with what the wall gives way",
        lowest=0.0,
        positive=True,
    ),
    Parameter("viscosity", "m^2/s", "kinematic viscosity of the oil", lowest=0.0),
)

_LAMINAR, _BLASIUS = 64.0, 0.3164
"""Darcy's friction factor of a round smooth tube: 64/Re, and 0.3164/Re^(1/4) where it is turbulent (Blasius 1913)."""


class Line(NamedTuple):
    """What moves in a line: pressures [Pa] from the valve on, and flows between them towards the chamber [m^3/s]."""

    p_0: float
    q_1: float
    p_1: float
    q_2: float
    p_2: float
    q_3: float
    p_3: float
    q_4: float


class Pipe(NamedTuple):
    """Numbers of a line's segments."""

    inertance: float  # [Pa s^2/m^3]
    capacity: float  # [m^3/Pa]
    laminar: float  # loss over flow [Pa s/m^3]
    bends: float  # loss over squared flow [Pa s^2/m^6]
    reynolds: float  # Reynolds number over flow [s/m^3]


class Source(NamedTuple):
    """What a valve's port gives: so much at no pressure, and so much less for each pascal [m^3/s, m^3/(s Pa)]."""

    flow: float
    conductance: float


class Fed(NamedTuple):
    """What long lines feed a joint's chambers, and what the valve draws for it [m^3/s]."""

    a: float
    b: float
    drawn: float


@njit
def pipe(length: float, bore: float, loss: float, joint: Any) -> Pipe:
    """A segment of a line [m, m, Pa s^2/m^6]."""
    p, density = joint.hose, joint.fluid.density
    own, area = length / SEGMENTS, 0.25 * math.pi * bore * bore
    inertance = density * own / area
    reynolds = 0.0
    if p.viscosity > 0.0:
        reynolds = bore / (area * p.viscosity)
    return Pipe(
        inertance,
        area * own / (density * p.wave_speed * p.wave_speed),
        32.0 * p.viscosity / (bore * bore) * inertance,
        loss / SEGMENTS,
        reynolds,
    )


@njit
def pipes(joint: Any) -> tuple[Pipe, Pipe]:
    """Segments of the lines at ports A and B."""
    p = joint.hose
    return pipe(p.length_a, p.bore_a, p.loss_a, joint), pipe(p.length_b, p.bore_b, p.loss_b, joint)


@njit
def resistance(flow: float, of: Pipe) -> float:
    """Loss of a segment over its flow [Pa s/m^3]: laminar, or by Blasius where that is more, and of the bends."""
    reynolds = of.reynolds * abs(flow)
    friction = of.laminar
    # the two laws cross at Re = (64/0.3164)^(4/3), 1187
    ratio = _BLASIUS / _LAMINAR * exponential(0.75 * logarithm(max(reynolds, 1.0)))
    if ratio > 1.0:
        friction *= ratio
    return friction + of.bends * abs(flow)


@njit
def _pushed(before: float, flow: float, behind: float, of: Pipe) -> float:
    """Rate of the flow in a segment [m^3/s^2] between two pressures."""
    return (before - behind - resistance(flow, of) * flow) / of.inertance


@njit
def line_rates(at: Line, source: Source, p_end: float, of: Pipe) -> Line:
    """Rates of what moves in a line, with a valve's port before it and a chamber's pressure behind it [Pa]."""
    entering = source.flow - source.conductance * at.p_0
    return Line(
        (entering - at.q_1) / (0.5 * of.capacity),
        _pushed(at.p_0, at.q_1, at.p_1, of),
        (at.q_1 - at.q_2) / of.capacity,
        _pushed(at.p_1, at.q_2, at.p_2, of),
        (at.q_2 - at.q_3) / of.capacity,
        _pushed(at.p_2, at.q_3, at.p_3, of),
        (at.q_3 - at.q_4) / of.capacity,
        _pushed(at.p_3, at.q_4, p_end, of),
    )


class Ended(NamedTuple):
    """A line with the pressure of its chamber, or their rates."""

    line: Line
    p_end: float


@njit
def _of_flow(
    f: float, behind: float, gives: float, flow: float, part: float, of: Pipe
) -> tuple[float, float]:
    """Rate a + b p' of a flow, with the pressure before it, where that behind is `behind` + `gives` times the flow."""
    inert = part / of.inertance
    lessened = 1.0 / (1.0 + inert * resistance(flow, of) + inert * gives)
    return lessened * (f - inert * behind), lessened * inert


@njit
def _of_pressure(f: float, leaving: float, yields: float, part: float, of: Pipe) -> tuple[float, float]:
    """Rate c + d q' of a pressure, with the flow before it, where that behind is `leaving` + `yields` times it."""
    soft = part / of.capacity
    lessened = 1.0 / (1.0 + soft * yields)
    return lessened * (f - soft * leaving), lessened * soft


@njit
def stage(at: Line, f: Ended, conductance: float, end: float, part: float, of: Pipe) -> Ended:
    """Rates k of a stage of a Rosenbrock-W method, (I - part J) k = f, see `solenoid.GAMMA`.

    J is the chain's own, with the losses' and the valve's secants, and has three diagonals: it is solved from the
    chamber to the valve and back.

    Args:
        at: where the step begins.
        f: rates where the stage is taken.
        conductance: of the valve's port where the step begins [m^3/(s Pa)].
        end: what the chamber gives way, with the last half segment [m^3/Pa].
        part: of the step [s].
        of: the line's segments.
    """
    k = f.line
    a_4, b_4 = _of_flow(k.q_4, f.p_end, part / end, at.q_4, part, of)
    c_3, d_3 = _of_pressure(k.p_3, a_4, b_4, part, of)
    a_3, b_3 = _of_flow(k.q_3, c_3, d_3, at.q_3, part, of)
    c_2, d_2 = _of_pressure(k.p_2, a_3, b_3, part, of)
    a_2, b_2 = _of_flow(k.q_2, c_2, d_2, at.q_2, part, of)
    c_1, d_1 = _of_pressure(k.p_1, a_2, b_2, part, of)
    a_1, b_1 = _of_flow(k.q_1, c_1, d_1, at.q_1, part, of)
    soft = part / (0.5 * of.capacity)
    p_0 = (k.p_0 - soft * a_1) / (1.0 + soft * (conductance + b_1))
    q_1 = a_1 + b_1 * p_0
    p_1 = c_1 + d_1 * q_1
    q_2 = a_2 + b_2 * p_1
    p_2 = c_2 + d_2 * q_2
    q_3 = a_3 + b_3 * p_2
    p_3 = c_3 + d_3 * q_3
    q_4 = a_4 + b_4 * p_3
    return Ended(Line(p_0, q_1, p_1, q_2, p_2, q_3, p_3, q_4), f.p_end + part / end * q_4)


@njit
def moved(at: Ended, k: Ended, h: float) -> Ended:
    """A line and its chamber after `h` seconds of held rates."""
    a, b = at.line, k.line
    return Ended(
        Line(
            a.p_0 + h * b.p_0,
            a.q_1 + h * b.q_1,
            a.p_1 + h * b.p_1,
            a.q_2 + h * b.q_2,
            a.p_2 + h * b.p_2,
            a.q_3 + h * b.q_3,
            a.p_3 + h * b.p_3,
            a.q_4 + h * b.q_4,
        ),
        at.p_end + h * k.p_end,
    )


@njit
def without_cavities(at: Line) -> Line:
    """A line whose pressures do not fall below zero."""
    return Line(
        max(at.p_0, 0.0), at.q_1, max(at.p_1, 0.0), at.q_2, max(at.p_2, 0.0), at.q_3, max(at.p_3, 0.0), at.q_4
    )


@njit
def at_rest(pressure: float) -> Line:
    """A line in which nothing flows, at a pressure [Pa]."""
    return Line(pressure, 0.0, pressure, 0.0, pressure, 0.0, pressure, 0.0)


LINES_SIZE = 2 * len(Line._fields)


class Lines(NamedTuple):
    """What moves in the lines of both ports."""

    a: Line
    b: Line


@njit
def lines_in(v: np.ndarray) -> Lines:
    """Lines from numbers. # (16,)."""
    return Lines(
        Line(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]),
        Line(v[8], v[9], v[10], v[11], v[12], v[13], v[14], v[15]),
    )


@njit
def put_lines(v: np.ndarray, lines: Lines) -> None:
    """Write them. # (16,)."""
    a, b = lines.a, lines.b
    v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7] = a.p_0, a.q_1, a.p_1, a.q_2, a.p_2, a.q_3, a.p_3, a.q_4
    v[8], v[9], v[10], v[11], v[12], v[13], v[14], v[15] = (
        b.p_0, b.q_1, b.p_1, b.q_2, b.p_2, b.q_3, b.p_3, b.q_4,
    )  # fmt: skip


@njit
def resting_lines(p_a: float, p_b: float) -> Lines:
    """Lines at rest at their chambers' pressures [Pa]."""
    return Lines(at_rest(p_a), at_rest(p_b))
