#!/usr/bin/env python3
"""Table 5.4 with simulated operators: joystick against assisted teleoperation, on one of the project's plants.

Random starts of the right arm and random pipes; every operator grasps each pipe by joystick, joint by joint, and with
the console: clicks, confirmation, automatic grasp. Writes the figures as JSON (`--out`) and prints them;
docs/evidence/teleop.md has the table, and hydrolek_drake/teleop/operator.yaml the operators' numbers. `--plant full`
is the hydraulic machine with contact; `--plant sdp` are chapter 6's models of its joints, from simulated step tests,
without contact. While an operator thinks and the arm stands still with closed valves, the plant is not simulated; the
time counts.
"""

import argparse
import datetime
import json
import logging
import time
from pathlib import Path

import numpy as np
from pydrake.systems.analysis import Simulator
from sdp_arms import SdpArms

from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.kinematics.jacobian import tool_jacobian
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.teleop.controllers.hydraulic_arms import JOINTS, HydraulicArms, joint_settings
from hydrolek_drake.teleop.hand import within_limits
from hydrolek_drake.teleop.joystick_operator import Goal, JoystickOperator
from hydrolek_drake.teleop.link.messages import decode, encode
from hydrolek_drake.teleop.operator_model import clicking, make_operator, operator_entries
from hydrolek_drake.teleop.plan import STEPS, plan_task
from hydrolek_drake.teleop.sequencer import Mode, TaskSequencer
from hydrolek_drake.teleop.stick_rates import stick_rates
from hydrolek_drake.vision.camera import camera_pose
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.selection import select_object
from hydrolek_drake.vision.snapshot import take_snapshot
from hydrolek_drake.vision.targets import pipe_targets, pixel_targets
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import with_arm
from hydrolek_drake.workcell.pipe import make_pipe, workcell_entries
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect
from hydrolek_drake.yaml_files import package_yaml

OPERATORS = ("inexperienced", "experienced")
CLICKS = 5  # snapshot, object, grasp, cut, confirmation
START_DEG = 10.0  # joints 1 to 5 start within this of the home posture
DISTANCES, SIDEWAYS, LEANING = (1.84, 1.90), 0.03, 0.3  # m before the machine, m to a side, of a pipe's axis


def draw_setup(generator: np.random.Generator) -> tuple:
    """Pipe and start posture for which the console finds a plan, that plan, its computing time, refusals before."""
    for refused in range(30):
        pipe = make_pipe(
            [generator.uniform(*DISTANCES), generator.uniform(-SIDEWAYS, SIDEWAYS), 1.06],
            [*generator.uniform(-LEANING, LEANING, 2), 1.0],
        )
        start = home_posture()
        start[:5] += np.radians(generator.uniform(-START_DEG, START_DEG, 5))
        start = within_limits(start)
        camera = SimulatedKinect(pipe, generator)
        camera.stand(start)
        frame, pose = camera.read(), camera_pose()
        points = [pipe.point + along * pipe.axis for along in (-0.05, 0.15)]
        clicks = [
            frame.camera.pixel(
                (in_frame(p, given_in="world", wanted_in="plate") - pose[:3, 3]) @ pose[:3, :3]
            )
            for p in points
        ]
        began = time.process_time()
        try:
            snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, default_settings())
            selected = select_object(snapshot, tuple(clicks[0])).mask
            pixels = pixel_targets(snapshot, selected, *clicks, frame.camera)
            targets = pipe_targets(snapshot, selected, pixels, frame.camera)
            plan = plan_task(targets, frame.camera, start, generator)
        except InputError as error:
            print(f"drawn again: {error}", flush=True)
            continue
        return pipe, start, plan, time.process_time() - began, refused
    raise InputError("no set-up could be planned in 30 draws")


def make_arms(plant: str, start: np.ndarray, pipe, settings: dict, seed: int):
    if plant == "sdp":
        return SdpArms(start, pipe, settings)
    return HydraulicArms(start, seed=seed, pipe=pipe, settings=settings)


def goals_of(plan, start: np.ndarray, tolerance: float) -> list[Goal]:
    """In front of the pipe, way points onto it, jaw closed: the way that the console's plan takes."""
    hand, values = operator_entries("hand"), workcell_entries()["grasp"]
    thinner = make_pipe(plan.pipe.point, plan.pipe.axis, plan.pipe.radius - values["give"], plan.pipe.length)
    seen = CollisionWorld(plan.pipe, padding=0.0), CollisionWorld(thinner, padding=0.0)
    count = int(np.ceil(np.linalg.norm(plan.grasp.points[-1] - plan.grasp.points[0]) / hand["way_points"]))
    rows = plan.grasp.angles[np.linspace(0, len(plan.grasp.angles) - 1, count + 1).round().astype(int)]
    goals = []
    for place, row in enumerate(rows):
        world_seen = seen[min(place, 1)]

        def free(first, second, world=world_seen):
            both = [with_arm(start, "right", each[:6]) for each in (first, second)]
            for posture, each in zip(both, (first, second), strict=True):
                posture[6] = each[6]
            return world.free_between(*(within_limits(each) for each in both))

        posture = np.append(row, np.radians(values["open_deg"]))
        goals.append(Goal(posture, levers_at(row), tolerance, free=free))
    closed = np.append(rows[-1], np.radians(values["closed_deg"]))
    only_jaw = np.append(np.zeros(6), hand["turn_lever"])
    return [*goals, Goal(closed, only_jaw, hand["still"], until_still=True)]


def levers_at(angles: np.ndarray) -> np.ndarray:
    """How far the tool goes with each joint of an arm in m/rad; the fingers' tips for turn and jaw."""
    levers = np.linalg.norm(tool_jacobian(angles)[:3], axis=0)
    return np.append(levers[:5], [operator_entries("hand")["turn_lever"]] * 2)


def outcome(arms, pipe, began_closing, pushed: float) -> dict:
    """Whether the pipe is held, and how well; `began_closing` is the posture when the jaw was told to close."""
    row = {"grip_N": float(arms.grip()[0]), "touched_before_N": pushed}
    row["held"] = arms.held() if isinstance(arms, SdpArms) else row["grip_N"] > 0.0
    if began_closing is not None:
        point = in_frame(tool_pose(began_closing[:6])[:3, 3], given_in="right_base", wanted_in="world")
        offset = point - pipe.point
        row["off_axis_mm"] = 1e3 * float(np.linalg.norm(offset - (offset @ pipe.axis) * pipe.axis))
    return row


def by_joystick(operator, plan, pipe, arms, goals: list[Goal], settings: dict, seed: int) -> dict:
    rates = stick_rates([settings[joint] for joint in JOINTS[:7]])
    person = JoystickOperator(operator, goals, rates, np.random.default_rng(seed))
    seconds, pushed, closing, deflection, reached = 0.0, 0.0, None, np.zeros(14), {}
    while not person.finished and seconds < operator_entries("hand")["patience"]:
        deflection[:7] = person.deflection(seconds, arms.position()[:7])
        reached.setdefault(person.goal, seconds)
        if person.goal < len(goals) - 1:
            pushed = max(pushed, float(arms.touch()[0]))
        elif closing is None:
            closing = arms.position()
        arms.advance(deflection=deflection)
        seconds += sample_s()
        if person.thinking_until is not None:
            seconds = max(seconds, person.thinking_until - sample_s())
    turns = sum(a.joint != b.joint for a, b in zip(person.moves, person.moves[1:], strict=False))
    return {
        "seconds": seconds,
        "finished": person.finished,
        "moves": len(person.moves),
        "changes_of_joint": turns,
        "in_front_after_s": reached.get(1),
        "on_pipe_after_s": reached.get(len(goals) - 1),
        "ways_not_seen_free": person.unseen_ways,
    } | outcome(arms, pipe, closing, pushed)


def automatically(plan, pipe, arms) -> dict:
    """Sequencer and plant until the jaw has closed."""
    sequencer = Simulator(TaskSequencer())
    system, own = sequencer.get_system(), sequencer.get_mutable_context()
    measured, pushed, closing = arms.advance(), 0.0, None
    system.start(own, plan, measured)
    while system.mode(own) is Mode.RUNNING and system.step_name(own) in STEPS[:3]:
        if system.step_name(own) != STEPS[2]:
            pushed = max(pushed, float(arms.touch()[0]))
        elif closing is None:
            closing = arms.position()
        system.position_measured_input.FixValue(own, measured)
        system.order_input.FixValue(own, [0.0])
        sequencer.AdvanceTo(system.one_update_on(own))
        measured = arms.advance(decode(encode(system.position_desired_output.Eval(own))).angles)
    done = system.step_name(own) == STEPS[3]
    return {"seconds": own.get_time(), "finished": done} | outcome(arms, pipe, closing, pushed)


def summary(rows: list[dict]) -> dict:
    """Mean and standard deviation over the set-ups, of those that were held."""
    found = {}
    for name in OPERATORS:
        for way in ("joystick", "assisted"):
            mine = [row[name][way] for row in rows]
            times = np.array([each["seconds"] for each in mine if each["held"] and each["finished"]])
            found[f"{name} {way}"] = {
                "held": len(times),
                "of": len(mine),
                "mean_s": float(times.mean()) if len(times) else None,
                "spread_s": float(times.std(ddof=1)) if len(times) > 1 else None,
                "least_s": float(times.min()) if len(times) else None,
                "most_s": float(times.max()) if len(times) else None,
            }
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--setups", type=int, default=6, help="random starts and pipes")
    own = 1e3 * operator_entries("hand")["tolerance"]
    parser.add_argument("--tolerance", type=float, default=own, help="of the operator at the tool, mm")
    parser.add_argument("--plant", choices=("full", "sdp"), default="full")
    parser.add_argument(
        "--out", type=Path, default=None, help="docs/evidence/data/operator_study_PLANT.json if not given"
    )
    arguments = parser.parse_args()
    logging.getLogger("drake").setLevel(logging.WARNING)
    out = arguments.out or Path(f"docs/evidence/data/operator_study_{arguments.plant}.json")
    settings = joint_settings(load_rig("hydrolek"))
    draw_setup(
        np.random.default_rng(arguments.seed)
    )  # compiles what is not yet compiled, so that no time is charged
    figures = {"date": datetime.date.today().isoformat(), "seed": arguments.seed, "plant": arguments.plant}
    figures |= {
        "controller": "feedforward",
        "tolerance_mm": arguments.tolerance,
        "clicks": CLICKS,
        "setups": [],
    }
    for number in range(arguments.setups):
        generator = np.random.default_rng([arguments.seed, number])
        pipe, start, plan, planning, refused = draw_setup(generator)
        row = {
            "pipe_point_m": pipe.point.tolist(),
            "pipe_axis": pipe.axis.tolist(),
            "start_deg": np.degrees(start[:5]).tolist(),
            "refused_draws": refused,
            "computing_s": planning,
            "machine": automatically(plan, pipe, make_arms(arguments.plant, start, pipe, settings, number)),
        }
        for name in OPERATORS:
            person = make_operator(name, generator)
            clicks = clicking(person, CLICKS)
            assisted = row["machine"] | {"seconds": clicks + planning + row["machine"]["seconds"]}
            arms = make_arms(arguments.plant, start, pipe, settings, number)
            goals = goals_of(plan, start, 1e-3 * arguments.tolerance)
            joystick = by_joystick(person, plan, pipe, arms, goals, settings, number)
            row[name] = {
                "pace": person.pace,
                "clicking_s": clicks,
                "joystick": joystick,
                "assisted": assisted,
            }
        figures["setups"].append(row)
        figures["summary"] = summary(figures["setups"])
        print(json.dumps(row), flush=True)
        write_whole(out, json.dumps(figures, indent=1) + "\n")  # what is measured is kept, however it ends
    print(json.dumps(figures["summary"], indent=1), f"\nfigures: {out}")
    printed = package_yaml("hydrolek_drake.teleop", "thesis_operators.yaml")
    for name in OPERATORS:
        times = {way: printed[name][way] for way in ("joystick", "assisted")}
        print(f"{printed['source']}: {name}, seconds: {json.dumps(times)}")


if __name__ == "__main__":
    main()
