#!/usr/bin/env python3
"""From picture to grasp and cut, measured on the hydraulic plant: error at the grasp by source, cut, and times.

Pipes upright, lying and tilted, at three distances, either arm grasping. Writes the figures as JSON (`--out`) and
prints them; docs/evidence/teleop.md has the table.
"""

import argparse
import datetime
import json
import logging
import time
from pathlib import Path

import numpy as np
from pydrake.systems.analysis import Simulator

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.hydraulic_arms import HydraulicArms, joint_settings
from hydrolek_drake.teleop.controllers.simulated_arms import SimulatedArms
from hydrolek_drake.teleop.link.messages import decode, encode
from hydrolek_drake.teleop.plan import STEPS, plan_task
from hydrolek_drake.teleop.sequencer import Mode, TaskSequencer
from hydrolek_drake.vision.camera import camera_pose, to_frame
from hydrolek_drake.vision.configuration import kinect_entries
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


class SimpleArms:
    """The stand-in with the interface of `HydraulicArms`; it reads what it is."""

    def __init__(self) -> None:
        self._period = teleop_entries("task")["period"]
        self._arms = SimulatedArms(home_posture(), self._period)
        self._simulator = Simulator(self._arms)
        self._arms.valves_open_input.FixValue(self._simulator.get_mutable_context(), [1.0])

    def advance(self, set_point: np.ndarray) -> np.ndarray:
        context = self._simulator.get_mutable_context()
        self._arms.position_desired_input.FixValue(context, set_point)
        self._simulator.AdvanceTo(context.get_time() + self._period)
        return self.position()

    def grip(self) -> np.ndarray:
        return np.zeros(2)

    def position(self) -> np.ndarray:
        return np.array(self._arms.position_measured_output.Eval(self._simulator.get_context()))


def carry_out(plan, side: str, arms) -> dict:
    """Sequencer and arms a period at a time, set points as text as on the link; what they did, and when.

    The tool is taken when the gripper is told to close; the blade's cutting point during the step of the cut.
    """
    sequencer = Simulator(TaskSequencer())
    system, own = sequencer.get_system(), sequencer.get_mutable_context()
    measured = arms.advance(home_posture())
    system.start(own, plan, measured)
    grasped, at_grasp, cut, worst = None, None, [], 0.0
    while system.mode(own) is Mode.RUNNING:
        step = system.step_name(own)
        desired = np.array(system.position_desired_output.Eval(own))
        if step in STEPS[:2]:
            at_grasp = desired, np.array(measured), arms.position()
        elif grasped is None:
            grasped = own.get_time()
        if step == "cut":
            cut.append(arms.position())
        system.position_measured_input.FixValue(own, measured)
        system.order_input.FixValue(own, [0.0])
        sequencer.AdvanceTo(system.one_update_on(own))
        measured = arms.advance(decode(encode(system.position_desired_output.Eval(own))).angles)
        worst = max(
            worst, float(np.abs(measured - desired)[:5].max()), float(np.abs(measured - desired)[7:12].max())
        )
    return {
        "mode": system.mode(own).name.lower(),
        "stopped_in": system.step_name(own),
        "to_grasp_s": grasped,
        "whole_task_s": own.get_time(),
        "largest_lag_deg": float(np.degrees(worst)),
        "grip_N": float(arms.grip()[0 if side == "right" else 1]),
        "jaw_deg": float(np.degrees(arms.position()[6 if side == "right" else 13])),
        "at_grasp": at_grasp,
        "cut": cut,
    }


def cut_figures(cut: list, plan, pipe, side: str) -> dict:
    """How far the blade's cutting point went across the true pipe, and how far off the plane of the cut it was."""
    cutting = "left" if side == "right" else "right"
    blade = kinect_entries("targets")["blade_reach"]
    along = plan.cut.points[-1] - plan.cut.points[0]
    along /= np.linalg.norm(along)
    middle = plan.cut.points.mean(axis=0) + blade * plan.cut.direction
    reached = []
    for posture in cut:
        pose = tool_pose(posture[:6] if cutting == "right" else posture[7:13])
        point = pose[:3, 3] + blade * pose[:3, 0]
        reached.append(in_frame(point, given_in=f"{cutting}_base", wanted_in="world") - middle)
    across = np.array(reached) @ along
    sideways = np.array(reached) @ pipe.axis
    within = np.abs(across) <= pipe.radius
    low, high = across.min(), across.max()
    covered = max(0.0, min(high, pipe.radius) - max(low, -pipe.radius)) / (2 * pipe.radius)
    return {
        "cut_covered": float(covered),
        "cut_off_plane_mm": 1e3 * float(np.abs(sideways[within]).max()) if within.any() else None,
    }


def measure(name: str, distance: float, side: str, seed: int, make_arms) -> dict:
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
        selected = select_object(snapshot, tuple(clicks[0])).mask
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
    arms = make_arms(pipe)
    done = carry_out(plan, side, arms)
    set_point, reading, reached = (tool(posture, side) for posture in done.pop("at_grasp"))
    cut = done.pop("cut")
    return (
        row
        | done
        | (cut_figures(cut, plan, pipe, side) if cut else {})
        | {
            "vision_mm": off_axis(seen, pipe),
            "kinematics_mm": 1e3 * float(np.linalg.norm(end - seen)),
            "control_mm": 1e3 * float(np.linalg.norm(reading - set_point)),
            "sensors_mm": 1e3 * float(np.linalg.norm(reached - reading)),
            "arms_mm": 1e3 * float(np.linalg.norm(reached - end)),
            "total_off_axis_mm": off_axis(reached, pipe),
            "tilt_deg": float(np.degrees(plan.grasp.tilt)),
        }
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--distance", type=float, action="append", help=f"m; {DISTANCES} if not given")
    parser.add_argument("--plant", choices=("full", "simple"), default="full")
    parser.add_argument("--controller", default="feedforward", help="of the full plant")
    parser.add_argument("--out", type=Path, default=Path("docs/evidence/data/teleop.json"))
    parser.add_argument("--add", action="store_true", help="measure only what --out does not hold yet")
    arguments = parser.parse_args()
    logging.getLogger("drake").setLevel(logging.WARNING)
    figures = {
        "date": datetime.date.today().isoformat(),
        "seed": arguments.seed,
        "plant": arguments.plant,
        "controller": arguments.controller if arguments.plant == "full" else None,
        "tasks": [],
    }
    if arguments.add:
        before = read_kept(arguments.out, "what was measured before")
        for name in ("seed", "plant", "controller"):
            if before[name] != figures[name]:
                parser.error(f"{arguments.out} was measured with {name} {before[name]}, not {figures[name]}")
        figures["tasks"] = before["tasks"]
    known = {(task["pipe"], task["distance_m"], task["grasps"]) for task in figures["tasks"]}
    settings = joint_settings(load_rig("hydrolek")) if arguments.plant == "full" else None

    def make_arms(pipe):
        if arguments.plant == "simple":
            return SimpleArms()
        return HydraulicArms(
            home_posture(),
            controller=arguments.controller,
            seed=arguments.seed,
            pipe=pipe,
            settings=settings,
        )

    for side in ("right", "left"):
        for name in AXES:
            for distance in arguments.distance or DISTANCES:
                if (name, distance, side) in known:
                    continue
                figures["tasks"].append(measure(name, distance, side, arguments.seed, make_arms))
                print(figures["tasks"][-1], flush=True)
                write_whole(
                    arguments.out, json.dumps(figures, indent=1) + "\n"
                )  # what is measured is kept, however it ends
    print(f"figures: {arguments.out}")


if __name__ == "__main__":
    main()
