#!/usr/bin/env python3
"""How far the Drake Diagram and the compiled rollout part over a random voltage, joint by joint.

Runs every instrumented joint of both arms with every effect off, and each effect on one joint after the other
(`--all` for each effect on every joint, which takes hours), and writes a table. Finished rows are kept, so an
interrupted study goes on where it was.
"""

import argparse
import datetime
import json
from pathlib import Path

import numpy as np

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rigs.rig import Rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import StepSizes, make_station

JOINTS = [f"hydrolek_{side}_j{number}" for side in ("right", "left") for number in range(1, 6)]
SIZES = Path(__file__).parent / "agreement_effects.json"


def random_voltage(duration: float, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Multi-level random voltage of section 6.1.4: levels within +-4 V, each held for 0.2 to 1 s."""
    times = np.arange(0.0, duration + 0.005, 0.01)
    volts = np.zeros(len(times))
    begin = 0.0
    while begin < duration:
        volts[times >= begin - 1e-9] = generator.uniform(-4.0, 4.0)
        begin += round(generator.uniform(0.2, 1.0), 2)
    return times, volts


def with_effect(rig: Rig, effect: str | None) -> Rig:
    """The rig with one effect on, at a size that is plainly visible, relative to the rig's own numbers."""
    if effect is None:
        return rig
    sizes = json.loads(SIZES.read_text())[effect]
    record = rig.records()[0]
    scale = {
        "force": float(record["cylinder"]["area_a"] * record["supply"]["pressure"]),
        "inertia": float(record["load"]["inertia"]),
    }
    return rig.with_values(
        {f"effects.{effect}.{name}": value * scale.get(of, 1.0) for name, (value, of) in sizes.items()}
    )


def compare(rig: Rig, duration: float, step: float, seed: int) -> tuple[float, float]:
    """Root mean square and largest difference of the readings [deg]."""
    times, volts = random_voltage(duration, np.random.default_rng(seed))
    outcome = roll_out(rig.records(), times, volts, times, longest_step=step / 5.0)
    station = make_station(rig, sizes=StepSizes(step=step), command=command_source(times, volts[:, None]))
    reading = run(station, duration).signals["reading"][:, 0]
    count = min(len(reading), len(times))
    difference = np.degrees(reading[:count] - outcome.signals.reading[:count])
    return float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max())


def main() -> None:
    """Run the study and write docs/agreement.md."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--duration", type=float, default=60.0, help="seconds of random voltage per case")
    parser.add_argument("--step", type=float, default=0.5e-3, help="step of the diagram [s]")
    parser.add_argument("--all", action="store_true", help="each effect on every joint")
    parser.add_argument("--out", type=Path, default=Path("docs/agreement.md"))
    arguments = parser.parse_args()
    cases = [(joint, None) for joint in JOINTS]
    effects = list(json.loads(SIZES.read_text()))
    if arguments.all:
        cases += [(joint, effect) for effect in effects for joint in JOINTS]
    else:
        cases += [(JOINTS[i % len(JOINTS)], effect) for i, effect in enumerate(effects)]
    kept = arguments.out.with_suffix(".partial.json")
    rows: dict[str, list[float]] = json.loads(kept.read_text()) if kept.exists() else {}
    for number, (joint, effect) in enumerate(cases):
        key = f"{joint} {effect or ''} {arguments.duration} {arguments.step}"
        if key not in rows:
            rig = with_effect(load_rig(joint), effect)
            rows[key] = list(compare(rig, arguments.duration, arguments.step, seed=number))
            kept.write_text(json.dumps(rows))
        print(
            f"{joint:18s} {effect or 'no effect':28s} rms {rows[key][0]:.4f} deg, largest {rows[key][1]:.4f} deg",
            flush=True,
        )
    write(arguments.out, cases, rows, arguments)
    kept.unlink()


def write(
    out: Path,
    cases: list[tuple[str, str | None]],
    rows: dict[str, list[float]],
    arguments: argparse.Namespace,
) -> None:
    """Write the table."""
    worst = max(rows[f"{j} {e or ''} {arguments.duration} {arguments.step}"][1] for j, e in cases)
    lines = [
        "# Diagram and rollout agree",
        "",
        f"Measured {datetime.date.today()} with `scripts/agreement.py`: "
        f"{arguments.duration:g} s of random voltage, "
        f"diagram at {arguments.step * 1e3:g} ms, rollout at a fifth of that. "
        f"Largest difference of all: {worst:.4f} deg "
        "(required: 0.02 deg).",
        "",
        "| joint | effect on | rms [deg] | largest [deg] |",
        "|---|---|---|---|",
    ]
    for joint, effect in cases:
        rms, largest = rows[f"{joint} {effect or ''} {arguments.duration} {arguments.step}"]
        lines.append(f"| {joint} | {effect or '-'} | {rms:.4f} | {largest:.4f} |")
    out.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    assert EFFECTS
    main()
