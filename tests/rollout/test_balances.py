"""Oil and energy are neither made nor lost between the valve, the chambers and the load."""

import numpy as np
from numpy.testing import assert_allclose

P_S, P_T, BULK = 16e6, 0.2e6, 1e9
AREA_A, AREA_B, DEAD = 800e-6, 600e-6, 40e-6
FRICTIONLESS = {"cylinder.viscous_friction": 0.0, "load.damping": 0.0}


def _edges(signals):
    """Flows P-A, A-T, P-B, B-T and their pressure drops, written out from bench.md 3."""
    opening = np.clip((np.abs(signals.spool) - 0.06e-3) / (0.35e-3 - 0.06e-3), 0.0, 1.0)
    right, left = np.where(signals.spool > 0, opening, 0.0), np.where(signals.spool < 0, opening, 0.0)
    drops = (
        P_S - signals.pressure_a,
        signals.pressure_a - P_T,
        P_S - signals.pressure_b,
        signals.pressure_b - P_T,
    )
    flows = [
        0.7 * 0.67e-6 * share * np.sqrt(2 / 870) * drop / (drop**2 + 0.2e6**2) ** 0.25
        for share, drop in zip((right, left, left, right), drops, strict=True)
    ]
    return flows, drops


def _volumes(signals):
    length = np.sqrt(0.12**2 + 0.35**2 - 2 * 0.12 * 0.35 * np.cos(signals.position + np.pi / 3))
    stroke = length - 0.2873493667
    return DEAD + AREA_A * stroke, DEAD + AREA_B * (0.40 - stroke)


def _run_both_ways(bench, run, values, step):
    """A smooth push out and back in, sampled at every step."""
    times = np.arange(0.0, 1.2, step)
    changes = np.arange(0.0, 1.2, 0.01)
    volts = 7.0 * np.sin(2 * np.pi * changes / 1.2)
    signals = run(bench, values, (changes, volts), times, longest_step=step).signals
    assert np.degrees(np.ptp(signals.position)) > 5  # it moves
    assert np.degrees(signals.position).max() < 65.6  # and meets no stop
    return times, signals


def test_oil_that_flows_in_is_piston_displacement_and_compression(bench, run):
    times, signals = _run_both_ways(bench, run, {}, 1e-4)
    assert min(signals.pressure_a.min(), signals.pressure_b.min()) > 0  # no void, whose volume is not counted
    (pa, at, pb, bt), _ = _edges(signals)
    volume_a, volume_b = _volumes(signals)
    for flow, volume, pressure in (
        (pa - at, volume_a, signals.pressure_a),
        (pb - bt, volume_b, signals.pressure_b),
    ):
        inflow = np.trapezoid(flow, times)
        displaced = volume[-1] - volume[0]
        compressed = np.trapezoid(volume, pressure) / BULK
        moved = np.trapezoid(np.abs(flow), times)
        residual = (inflow - displaced - compressed) / moved
        print(f"oil residual {residual:.1e} of what flowed")
        assert abs(residual) < 1e-4


def _energy_residual(bench, run, step):
    """Energy that is missing over what the pump delivered, for a machine without friction."""
    times, signals = _run_both_ways(bench, run, FRICTIONLESS, step)
    (pa, at, pb, bt), drops = _edges(signals)
    delivered = np.trapezoid(P_S * (pa + pb) - P_T * (at + bt), times)
    throttled = np.trapezoid(sum(q * dp for q, dp in zip((pa, at, pb, bt), drops, strict=True)), times)
    volume_a, volume_b = _volumes(signals)
    compressed = sum(
        np.trapezoid(volume * pressure, pressure) / BULK
        for volume, pressure in ((volume_a, signals.pressure_a), (volume_b, signals.pressure_b))
    )
    kinetic = 0.5 * 25.0 * (signals.velocity[-1] ** 2 - signals.velocity[0] ** 2)
    lifted = 265.0 * (np.sin(signals.position[-1]) - np.sin(signals.position[0]))
    return (delivered - throttled - compressed - kinetic - lifted) / delivered


def test_energy_from_the_pump_is_throttled_stored_and_lifted(bench, run):
    """Without friction nothing else takes energy; what is missing is the integrator's error, of order two."""
    residuals = [_energy_residual(bench, run, step) for step in (4e-4, 2e-4, 1e-4)]
    print("energy residuals", residuals)
    assert abs(residuals[-1]) < 1e-4
    assert_allclose(np.log2(residuals[0] / residuals[2]) / 2, 2.0, atol=0.5)
