"""Every search at equal budgets on bench recordings: error over noise on holdout, and parameter error.

Four parameters are searched in a wide box; all others have the values that the recording was made with. The budgets
come from one run: nothing but the final mean of NSGA-II looks at the budget, and that is taken anew over the
evaluations that count. Rows are written after each run, and runs that are there already are not made again.
"""

import argparse
import json
import time
from datetime import date
from pathlib import Path

import numpy as np

from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit.rig_objective import RigObjective
from hydrolek_drake.identification.parameter_set import Free, ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.search.genetic.multi_objective import pareto_set
from hydrolek_drake.identification.search.search import METHODS, SearchResult, search
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig

ROOT = Path(__file__).parents[1]
BENCH = ROOT / "tests" / "data" / "bench"
BUDGETS = (2000, 8000)
LABELS = json.loads((BENCH / "rig_paths.json").read_text())
"""Label of a practice recording -> parameter that it sets; side b follows side a (`same_as`)."""

SEARCHED = ("A_max_m2", "x_o_m", "P_S_Pa", "T_d_s")
"""Labels whose parameters are searched: on the wide box the path that follows (`same_as`) goes with them."""


def main() -> None:
    """Run what is missing and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pair", default="practice_01")
    parser.add_argument(
        "--seconds", type=float, default=6.0, help="of the estimation recording that are fitted"
    )
    parser.add_argument(
        "--step", type=float, default=2e-3, help="longest integration step of the searches [s]"
    )
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument(
        "--factor", type=float, default=2.0, help="half width of the box about the rig's values"
    )
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "evidence" / "data" / "method_table.json")
    arguments = parser.parse_args()
    labels = {entry["id"]: entry for entry in json.loads((BENCH / "practice_labels.json").read_text())}
    machine = labels[arguments.pair]["machine"]
    nominal = load_rig("joint_bench")
    rest = {path: machine[key] for key, path in LABELS.items() if key not in SEARCHED}
    rig = nominal.with_values(rest)
    free = [
        Free(
            rig.full_path(LABELS[key]),
            nominal.value(LABELS[key]) / arguments.factor,
            nominal.value(LABELS[key]) * arguments.factor,
            log=True,
        )
        for key in SEARCHED
    ]
    parameters = ParameterSet(rig, free)
    read = {
        part: read_recording(BENCH / arguments.pair / f"{part}.csv", rig.columns)
        for part in ("train", "holdout")
    }
    start = read["train"].time[0]
    train = read["train"].between(start, start + arguments.seconds)
    problem = Problem(parameters, experiments_of(rig, train), longest_step=arguments.step)
    judge = Problem(parameters, experiments_of(rig, read["holdout"]))
    true = parameters.unit({one.path: machine[key] for one, key in zip(free, SEARCHED, strict=True)})
    conditions = {
        "pair": arguments.pair,
        "seconds": arguments.seconds,
        "longest_step": arguments.step,
        "box_factor": arguments.factor,
        "searched": [one.path for one in free],
        "holdout_over_noise_of_the_true_values": over_noise(judge, true),
    }
    rows = kept_rows(arguments.out, conditions)
    for seed in range(1, arguments.seeds + 1):
        for method in METHODS:
            if any(row["method"] == method and row["seed"] == seed for row in rows):
                continue
            began = time.perf_counter()
            objective = RigObjective(problem, 2.0, 8 if method == "nsga2" else None)
            ends = np.zeros(len(free)), np.ones(len(free))
            found = search(method, objective, *ends, max(BUDGETS), np.random.default_rng(seed))
            if found.interrupted:
                raise KeyboardInterrupt
            for budget in BUDGETS:
                place = solution(found, budget)
                values = parameters.values(place)
                off = [
                    abs(values[one.path] / machine[key] - 1.0)
                    for one, key in zip(free, SEARCHED, strict=True)
                ]
                rows.append(
                    {
                        "method": method,
                        "budget": budget,
                        "seed": seed,
                        "evaluations": min(budget, found.evaluations),
                        "holdout_over_noise": over_noise(judge, place),
                        "sum_of_relative_errors": sum(off),
                        "seconds": time.perf_counter() - began,
                    }
                )
            print(
                f"seed {seed} {method}: {rows[-1]['holdout_over_noise']:.3f}, {rows[-1]['seconds']:.0f} s",
                flush=True,
            )
            content = {"date": date.today().isoformat(), **conditions, "runs": rows}
            write_whole(arguments.out, json.dumps(content, indent=1) + "\n")
    print(table(rows))


def solution(found: SearchResult, budget: int) -> np.ndarray:
    """Where a search stood after so many evaluations: the best, or NSGA-II's mean of each segment's best."""
    units, scores = found.units[:budget], found.scores[:budget]
    if found.method == "nsga2":
        return pareto_set(units, scores).average
    return units[int(np.argmin(scores[:, 0]))]


def over_noise(problem: Problem, unit: np.ndarray) -> float:
    """Rms of the residuals over the noise."""
    residuals = problem.residuals(unit)
    return float(np.sqrt(residuals @ residuals / problem.counted))


def kept_rows(path: Path, conditions: dict) -> list[dict]:
    """Rows that were made before under the same conditions."""
    if not path.is_file():
        return []
    before = read_kept(path, "the runs made before", ("runs",))
    same = all(before.get(key) == value for key, value in conditions.items())
    return list(before["runs"]) if same else []


def table(rows: list[dict]) -> str:
    """Medians, with best and worst, as a table for the documentation."""
    lines = [
        "| method | evaluations | runs | held out / noise: median (best, worst) | sum of errors: median (best, worst) |"
    ]
    lines.append("|---|---|---|---|---|")
    for method in METHODS:
        for budget in BUDGETS:
            own = [row for row in rows if row["method"] == method and row["budget"] == budget]
            cells = []
            for key in ("holdout_over_noise", "sum_of_relative_errors"):
                values = [row[key] for row in own]
                cells.append(f"{np.median(values):.3g} ({min(values):.3g}, {max(values):.3g})")
            lines.append(f"| `{method}` | {budget} | {len(own)} | {cells[0]} | {cells[1]} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
