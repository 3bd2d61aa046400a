#!/usr/bin/env python3
"""From picture to grasp and cut, measured on simulated arms: error at the grasp by source, and times.

Pipes upright, lying and tilted, at three distances, either arm grasping. Writes the figures as JSON (`--out`) and
prints them; docs/teleop.md has the table.
"""

import argparse
import datetime
import json
import logging
import time
from pathlib import Path

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.plan import STEPS, plan_task
from hydrolek_drake.teleop.sequencer import Mode, TaskSequencer
from hydrolek_drake.teleop.simulated_arms import SimulatedArms
from hydrolek_drake.vision.camera import camera_pose, to_frame
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.selection import select_object
from hydrolek_drake.vision.snapshot import take_snapshot
from hydrolek_drake.vision.targets import pipe_targets, pixel_targets
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect

AXES = {"vertical": (0, 0, 1), "horizontal": (0, 1, 0), "tilted": (0.2, 0.4, 1)}
DISTANCES = (1.80, 1.85, 1.90)  # m before the machine's middle: 1.23 to 1.33 m from the camera


def off_axis(point: np.ndarray, pipe) -> float:
    offset = point - pipe.point
    return 1e3 * float(np.linalg.norm(offset - (offset @ pipe.axis) * pipe.axis))


def tool(posture: np.ndarray, side: str) -> np.ndarray:
    angles = posture[:6] if side == "right" else posture[7:13]
    return in_frame(tool_pose(angles)[:3, 3], given_in=f"{side}_base", wanted_in="world")


def carry_out(plan, side: str) -> dict:
    """Sequencer and arms as one diagram; the tool when the grasp is reached, and the times."""
    builder, period = DiagramBuilder(), teleop_entries("task")["period"]
    sequencer, arms = (
        builder.AddSystem(TaskSequencer()),
        builder.AddSystem(SimulatedArms(home_posture(), period)),
    )
    order = builder.AddSystem(ConstantVectorSource([0.0]))
    builder.Connect(arms.position_measured_output, sequencer.position_measured_input)
    builder.Connect(order.get_output_port(), sequencer.order_input)
    builder.Connect(sequencer.position_desired_output, arms.position_desired_input)
    builder.Connect(sequencer.valves_open_output, arms.valves_open_input)
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = simulator.get_mutable_context()
    own = sequencer.GetMyMutableContextFromRoot(context)
    simulator.AdvanceTo(period)
    sequencer.start(own, plan, home_posture())
    begin, grasped, at_grasp = context.get_time(), None, None
    while sequencer.mode(own) is Mode.RUNNING:
        if sequencer.step_name(own) in STEPS[:2]:
            at_grasp = np.array(arms.position_measured_output.Eval(arms.GetMyContextFromRoot(context)))
        elif grasped is None:
            grasped = context.get_time() - begin
        simulator.AdvanceTo(context.get_time() + period)
    return {
        "mode": sequencer.mode(own).name.lower(),
        "to_grasp_s": grasped,
        "whole_task_s": context.get_time() - begin,
        "tool": tool(at_grasp, side),
    }


def measure(name: str, distance: float, side: str, seed: int) -> dict:
    pipe = make_pipe([distance, 0.0, 1.06], AXES[name])
    row = {"pipe": name, "distance_m": distance, "grasps": side}
    frame = SimulatedKinect(pipe, np.random.default_rng(seed)).read()
    pose = camera_pose()
    snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, default_settings())
    sign = 1.0 if side == "right" or name != "horizontal" else -1.0  # the cutting arm's side of the grasp
    wanted = [pipe.point + sign * along * pipe.axis for along in (-0.05, 0.15)]
    points = [(in_frame(p, given_in="world", wanted_in="plate") - pose[:3, 3]) @ pose[:3, :3] for p in wanted]
    clicks = [frame.camera.pixel(point) for point in points]
    try:
        selected = select_object(snapshot, tuple(clicks[0]))
        pixels = pixel_targets(snapshot, selected, *clicks, frame.camera)
        targets = pipe_targets(snapshot, selected, pixels, frame.camera)
        begin = time.perf_counter()
        plan = plan_task(targets, frame.camera, home_posture(), np.random.default_rng(seed), grasping=side)
    except InputError as error:
        return row | {"refused": str(error)}
    row["planning_s"] = time.perf_counter() - begin
    planned = plan.steps[1].trajectory
    end = tool(planned.value(planned.end_time())[:, 0], side)
    seen = to_frame(targets.grasp, "world")
    done = carry_out(plan, side)
    reached = done.pop("tool")
    return (
        row
        | done
        | {
            "vision_mm": off_axis(seen, pipe),
            "kinematics_mm": 1e3 * float(np.linalg.norm(end - seen)),
            "arms_mm": 1e3 * float(np.linalg.norm(reached - end)),
            "total_off_axis_mm": off_axis(reached, pipe),
            "tilt_deg": float(np.degrees(plan.grasp.tilt)),
        }
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("docs/teleop.json"))
    arguments = parser.parse_args()
    logging.getLogger("drake").setLevel(logging.WARNING)
    figures = {"date": datetime.date.today().isoformat(), "seed": arguments.seed, "tasks": []}
    for side in ("right", "left"):
        for name in AXES:
            for distance in DISTANCES:
                figures["tasks"].append(measure(name, distance, side, arguments.seed))
                print(figures["tasks"][-1], flush=True)
    draft = arguments.out.with_suffix(".json.part")
    draft.write_text(json.dumps(figures, indent=1) + "\n")
    print(f"figures: {draft.rename(arguments.out)}")


if __name__ == "__main__":
    main()
