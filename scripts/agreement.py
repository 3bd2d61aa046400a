#!/usr/bin/env python3
"""How far the Drake Diagram and the compiled rollout part over a random voltage, joint by joint.

Runs every instrumented joint of both arms with every effect off, and each effect on one joint after the other
(`--all` for each effect on every joint). To save time many joints share a diagram: a joint whose neighbours are
held is one rigid body on a fixed axis, so each case is a body of its own with that inertia and gravity. At the end
every joint runs on the arms' own plant, one of each arm at a time. Finished rows are kept, so an interrupted
study goes on where it was.

With `--own` the diagram takes the step that it takes where none is given, with `--closed` controllers drive both
executions; either writes its own table anew.
"""

import argparse
import datetime
import json
from pathlib import Path

from two_executions.cases import (
    BLOWS,
    JOINTS,
    SIZES,
    Case,
    bodies,
    fits_one_body,
    on_the_arms,
    parted,
    share_of_step,
)
from two_executions.differences import closed, compare

from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.station.step_sizes import sizes_for

CONTROLLERS = ("feedforward", "pip_idz_c", "pip_forward_c")
"""The project's own, and what the thesis recommends of feedback and of forward path for steps (section 6.3)."""

CLOSED, OWN = "in closed loop", "at the diagram's own step"
"""Tables that are written by themselves."""

Row = tuple[
    str, str, str | None, float, float, float
]  # plant, joint, effect, step, root mean square, largest

ONE_BODY, ARMS = "one body", "arms"


def closed_table() -> str:
    """The table of all joints under the controllers of `CONTROLLERS`, at the diagram's own step and half of it."""
    titles = [f"{name}, {which}" for name in CONTROLLERS for which in ("1 ms", "0.5 ms")]
    lines = [f"| joint | {' | '.join(titles)} |", "|---" * (1 + len(titles)) + "|"]
    for joint in JOINTS:
        own, half = closed(joint, CONTROLLERS), closed(joint, CONTROLLERS, 0.5e-3)
        cells = [f"{value:.4f}" for pair in zip(own, half, strict=True) for value in pair]
        lines.append(f"| {joint} | {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    return "\n".join(lines)


def own_table(duration: float) -> str:
    """The table of all joints at the step of `sizes_for`, without an effect and with a play that closes."""
    lines = ["| joint | effect on | step [ms] | rms [deg] | largest [deg] |", "|---|---|---|---|---|"]
    for effect in (None, BLOWS):
        rig = bodies([(joint, effect) for joint in JOINTS])
        step = sizes_for(rig).step
        figures = compare(rig, duration, step, *range(len(JOINTS)))
        lines += [
            f"| {joint} | {effect or '-'} | {1e3 * step:g} | {rms:.4f} | {largest:.4f} |"
            for joint, (rms, largest) in zip(JOINTS, figures, strict=True)
        ]
    return "\n".join(lines)


def write_table(out: Path, name: str, table: str) -> None:
    """Put a table between its two marks."""
    begins, ends = f"<!-- {name} -->\n", f"\n<!-- end: {name} -->"
    text = out.read_text()
    out.write_text(f"{text.partition(begins)[0]}{begins}{table}{ends}{text.partition(ends)[2]}")


def main() -> None:
    """Run the study and write docs/evidence/agreement.md, anew after each diagram."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--duration", type=float, default=60.0, help="seconds of random voltage per case")
    parser.add_argument("--step", type=float, default=0.4e-3, help="step of the diagram [s]")
    parser.add_argument("--all", action="store_true", help="then each effect on every other joint")
    parser.add_argument("--own", action="store_true", help="at the step that is taken where none is given")
    parser.add_argument("--closed", action="store_true", help="controllers in both executions")
    parser.add_argument("--out", type=Path, default=Path("docs/evidence/agreement.md"))
    arguments = parser.parse_args()
    if arguments.closed:
        write_table(arguments.out, CLOSED, closed_table())
        return
    if arguments.own:
        write_table(arguments.out, OWN, own_table(arguments.duration))
        return
    effects = list(json.loads(SIZES.read_text()))
    cases: list[Case] = [(joint, None) for joint in JOINTS]
    cases += [(JOINTS[i % len(JOINTS)], effect) for i, effect in enumerate(effects)]
    more = [(joint, effect) for joint in JOINTS for effect in effects if (joint, effect) not in cases]
    seeds = {case: number for number, case in enumerate(cases + more)}
    runs: list[tuple[str, list[Case]]] = [(ONE_BODY, part) for part in parted(cases)]
    runs += [(ARMS, [case]) for case in cases if not fits_one_body(case)]
    runs += [(ARMS, [(JOINTS[i], None), (JOINTS[i + 5], None)]) for i in range(5)]
    if arguments.all:
        for part in parted(more):
            runs += [(ONE_BODY, part[i : i + len(cases)]) for i in range(0, len(part), len(cases))]
        runs += [(ARMS, [case]) for case in more if not fits_one_body(case)]
    kept = arguments.out.with_suffix(".partial.json")
    rows: list[Row] = (
        [tuple(row) for row in read_kept(kept, "what an earlier run compared")] if kept.exists() else []
    )
    for plant, together in runs:
        if any(row[:3] == (plant, *together[0]) for row in rows):
            continue
        rig = bodies(together) if plant == ONE_BODY else on_the_arms(together)
        step = arguments.step * share_of_step(together[0])
        figures = compare(rig, arguments.duration, step, *(seeds[case] for case in together))
        rows += [(plant, *case, step, *figure) for case, figure in zip(together, figures, strict=True)]
        write_whole(kept, json.dumps(rows))
        for row in rows[-len(together) :]:
            print(
                "{:9s} {:18s} {!s:28s} step {:g} s: rms {:.4f} deg, largest {:.4f} deg".format(*row),
                flush=True,
            )
        wanted = set(cases + more if arguments.all else cases)
        done = len({row[1:3] for row in rows} & wanted)
        write(arguments.out, rows, f"{done} of {len(wanted)}", arguments.duration)
    kept.unlink()


def write(out: Path, rows: list[Row], done: str, duration: float) -> None:
    """Write the table of what is done; sections that were written below an older one stay."""
    _, heading, below = (out.read_text() if out.exists() else "").partition("\n## ")
    plant, joint, effect, _, _, worst = max(rows, key=lambda row: row[5])
    lines = [
        "# Diagram and rollout agree",
        "",
        f"Measured {datetime.date.today()} with `scripts/agreement.py`: {duration:g} s of random voltage a case, "
        "the rollout at a fifth of the diagram's",
        f"step. Required: 0.02 deg at any moment. Largest difference of all {len(rows)} runs: {worst:.4f} deg "
        f"({joint}, {effect or 'no effect'}, {plant}).",
        "",
        f"{done} cases are done: every joint without effects and with each effect. `one body`: many cases "
        "share a diagram,",
        "each a rigid body of its own with the inertia and gravity that the joint has while the others are held; "
        "`arms`: on the",
        "plant of both arms, a joint of each arm at a time.",
        "",
        "| plant | joint | effect on | step [ms] | rms [deg] | largest [deg] |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {p} | {j} | {e or '-'} | {1e3 * step:g} | {rms:.4f} | {largest:.4f} |"
        for p, j, e, step, rms, largest in rows
    ]
    write_whole(out, "\n".join(lines) + "\n" + heading + below)


if __name__ == "__main__":
    main()
