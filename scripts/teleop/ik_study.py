#!/usr/bin/env python3
"""Inverse kinematics measured: Table 5.3's study of the Jacobian transpose, the closed form, and Drake beside it.

Writes the figures as JSON (`--out`) and prints the tables of docs/evidence/kinematics.md.
"""

import argparse
import datetime
import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from pydrake.multibody.inverse_kinematics import InverseKinematics
from pydrake.solvers import Solve

from hydrolek_drake.files import write_whole
from hydrolek_drake.kinematics.arms import make_arms_plant, position_indices
from hydrolek_drake.kinematics.chain import arm_chain, joint_limits
from hydrolek_drake.kinematics.forward import tool_pose, wrist_position
from hydrolek_drake.kinematics.inverse import inverse_pose, inverse_position
from hydrolek_drake.kinematics.jacobian_transpose import jacobian_transpose

TABLE_5_3_MM = {5.0: 6.3496, 2.0: 2.9087, 1.0: 2.7949, 0.5: 1.6577, 0.1: 1.3907}
"""Tolerance and mean error that the thesis prints."""
OUTLIER = 0.010  # m: "errors greater than 10 mm are removed"
PRECISE = 1e-4  # m: the 0.1 mm that the closed form shall keep


def random_postures(count: int, side: str, generator: np.random.Generator) -> np.ndarray:
    """Joints 1 to 6 uniform within their limits, joint 6 over one turn; shape (count, 6)."""
    lower, upper = (limits[:6].copy() for limits in joint_limits(side))
    lower[5], upper[5] = -np.pi, np.pi
    return generator.uniform(lower, upper, (count, 6))


def table_5_3(count: int, most_iterations: int, generator: np.random.Generator) -> list[dict]:
    """The thesis's study: each target is the wrist at random angles, started from the angles of the last."""
    postures = random_postures(count + 1, "right", generator)
    targets = wrist_position(postures)
    rows = []
    jacobian_transpose(targets[0], postures[1], tolerance=0.1, most_iterations=1)  # compiles
    for tolerance_mm, printed in TABLE_5_3_MM.items():
        angles, errors, times, steps = postures[0], [], [], []
        for target in targets[1:]:
            begin = time.perf_counter()
            result = jacobian_transpose(
                target, angles, tolerance=tolerance_mm * 1e-3, most_iterations=most_iterations
            )
            times.append(time.perf_counter() - begin)
            errors.append(result.error)
            steps.append(result.iterations)
            angles = result.angles
        errors = np.array(errors)
        rows.append(
            {
                "tolerance_mm": tolerance_mm,
                "mean_time_ms": 1e3 * float(np.mean(times)),
                "longest_time_ms": 1e3 * float(np.max(times)),
                "mean_error_mm": 1e3 * float(errors.mean()),
                "mean_error_without_outliers_mm": 1e3 * float(errors[errors <= OUTLIER].mean()),
                "outliers": int((errors > OUTLIER).sum()),
                "not_within_tolerance": int((errors > tolerance_mm * 1e-3).sum()),
                "median_iterations": float(np.median(steps)),
                "thesis_mean_error_mm": printed,
            }
        )
    return rows


def measure(solve: Callable, postures: np.ndarray, side: str, directed: bool) -> dict:
    """Time and error of a solver on the tool's poses at `postures`; `solve` gives angles or None."""
    poses = tool_pose(postures)
    solve(poses[0], side)  # compiles
    lower, upper = (limits[:6] for limits in joint_limits(side))
    times, good = [], 0
    for pose in poses:
        begin = time.perf_counter()
        angles = solve(pose, side)
        times.append(time.perf_counter() - begin)
        if angles is None or np.any(angles < lower - 1e-9) or np.any(angles > upper + 1e-9):
            continue
        reached = tool_pose(angles)
        near = np.linalg.norm(reached[:3, 3] - pose[:3, 3]) <= PRECISE
        along = not directed or np.linalg.norm(reached[:3, 0] - pose[:3, 0]) <= 1e-3
        good += bool(near and along)
    return {
        "side": side,
        "targets": len(postures),
        "mean_ms": 1e3 * float(np.mean(times)),
        "median_ms": 1e3 * float(np.median(times)),
        "p99_ms": 1e3 * float(np.percentile(times, 99)),
        "solved_percent": 100.0 * good / len(postures),
    }


def closed_position(pose: np.ndarray, side: str) -> np.ndarray | None:
    result = inverse_position(pose[:3, 3], side, explain=False)
    return result.angles[0] if result.reached else None


def closed_pose(pose: np.ndarray, side: str) -> np.ndarray | None:
    result = inverse_pose(pose[:3, 3], pose[:3, 0], side, jaw_axis=pose[:3, 2], explain=False)
    return result.angles[0] if result.reached else None


class DrakeSolver:
    """Drake's InverseKinematics program with its own choice of solver, started from mid-travel, then at random."""

    def __init__(self, side: str, directed: bool, starts: int, generator: np.random.Generator) -> None:
        other = "left" if side == "right" else "right"
        held = {f"{other}_j{n}": 0.0 for n in range(1, 8)} | {f"{side}_j7": 0.0}
        self.plant = make_arms_plant(held)
        self.side, self.directed, self.starts, self.generator = side, directed, starts, generator
        self.order = position_indices(self.plant, [f"{side}_j{n}" for n in range(1, 7)])

    def __call__(self, pose: np.ndarray, side: str) -> np.ndarray | None:
        plant, chain = self.plant, arm_chain(side)
        base, tool = plant.GetFrameByName(f"{side}_base"), plant.GetFrameByName(f"{side}_tool")
        for start in range(self.starts):
            program = InverseKinematics(plant)
            box = 1e-5
            program.AddPositionConstraint(tool, np.zeros(3), base, pose[:3, 3] - box, pose[:3, 3] + box)
            if self.directed:
                program.AddAngleBetweenVectorsConstraint(base, pose[:3, 0], tool, np.eye(3)[0], 0.0, 1e-4)
            guess = np.zeros(6)
            guess[self.order] = chain.middle if start == 0 else random_postures(1, side, self.generator)[0]
            program.prog().SetInitialGuess(program.q(), guess)
            result = Solve(program.prog())
            if result.is_success():
                return result.GetSolution(program.q())[self.order]
        return None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--targets", type=int, default=10_000, help="for the closed form, each arm")
    parser.add_argument("--drake-targets", type=int, default=300)
    parser.add_argument("--most-iterations", type=int, default=10_000, help="of the Jacobian transpose")
    parser.add_argument("--seed", type=int, default=53)
    parser.add_argument("--out", type=Path, default=Path("docs/evidence/data/kinematics.json"))
    arguments = parser.parse_args()
    generator = np.random.default_rng(arguments.seed)

    figures: dict = {"date": datetime.date.today().isoformat(), "seed": arguments.seed}
    figures["table_5_3"] = table_5_3(400, arguments.most_iterations, generator)
    for row in figures["table_5_3"]:
        print(row)
    solvers: list = []
    for side in ("right", "left"):
        postures = random_postures(arguments.targets, side, generator)
        solvers.append(("closed form, position", closed_position, postures, side, False))
        solvers.append(("closed form, position and direction", closed_pose, postures, side, True))
    postures = random_postures(arguments.drake_targets, "right", generator)
    for directed in (False, True):
        for starts in (1, 10):
            what = "position and direction" if directed else "position"
            drake = DrakeSolver("right", directed, starts, generator)
            solvers.append((f"Drake, {what}, {starts} start(s)", drake, postures, "right", directed))
    figures["solvers"] = []
    for name, solve, targets, side, directed in solvers:
        figures["solvers"].append({"solver": name} | measure(solve, targets, side, directed))
        print(figures["solvers"][-1])
    write_whole(arguments.out, json.dumps(figures, indent=1) + "\n")
    print(f"figures: {arguments.out}")


if __name__ == "__main__":
    main()
