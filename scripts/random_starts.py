"""Least squares on the healthy bench pairs from random starts in the rig's ranges: does every one end at the noise?

Each start stands alone: no second chance from another start. Writes
docs/evidence/data/random_starts.json after every start.
"""

import argparse
import json
import time
from datetime import date
from pathlib import Path

import numpy as np

from hydrolek_drake.files import write_whole
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit.report import AT_NOISE
from hydrolek_drake.identification.least_squares.least_squares import fit_from_afar
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig

ROOT = Path(__file__).parents[1]


def main() -> None:
    """Fit each pair from each start and write what came out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--out", type=Path, default=ROOT / "docs" / "evidence" / "data" / "random_starts.json"
    )
    arguments = parser.parse_args()
    rig = load_rig("joint_bench")
    parameters = ParameterSet(rig, free_parameters(rig))
    names = ("practice_01", "practice_02")
    problems = {
        (name, part): Problem(
            parameters,
            experiments_of(
                rig, read_recording(ROOT / "tests" / "data" / "bench" / name / f"{part}.csv", rig.columns)
            ),
        )
        for name in names
        for part in ("train", "holdout")
    }
    rng = np.random.default_rng(arguments.seed)
    starts = rng.uniform(size=(arguments.starts, len(parameters)))
    rows = []
    for number, start in enumerate(starts):
        for name in names:
            began = time.perf_counter()
            fit = fit_from_afar(problems[name, "train"], start)
            seconds = time.perf_counter() - began
            judge = problems[name, "holdout"]
            residuals = judge.residuals(fit.unit)
            holdout = float(np.sqrt(residuals @ residuals / judge.counted))
            rows.append(
                {
                    "recording": name,
                    "start": number,
                    "over_noise": fit.over_noise,
                    "holdout_over_noise": holdout,
                    "evaluations": fit.evaluations,
                    "seconds": seconds,
                }
            )
            reached = sum(row["holdout_over_noise"] <= AT_NOISE for row in rows)
            print(
                f"{name} start {number}: {fit.over_noise:.3f}, holdout {holdout:.3f}, {fit.evaluations} "
                f"evaluations, {seconds:.1f} s; {reached} of {len(rows)} at the noise on holdout",
                flush=True,
            )
            content = {"date": date.today().isoformat(), "seed": arguments.seed, "fits": rows}
            write_whole(arguments.out, json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
