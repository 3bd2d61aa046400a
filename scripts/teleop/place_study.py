#!/usr/bin/env python3
"""Pick and place on the hydraulic plant: where the loose pipe ends, how it was held and what it all took.

Writes the figures as JSON (`--out`) and prints them; docs/evidence/teleop.md has them.
"""

import argparse
import datetime
import json
import logging
from pathlib import Path

import numpy as np
from pydrake.systems.analysis import Simulator

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.teleop.controllers.hydraulic_arms import HydraulicArms, joint_settings
from hydrolek_drake.teleop.link.messages import decode, encode
from hydrolek_drake.teleop.place_plan import plan_place_by_either
from hydrolek_drake.teleop.sequencer import Mode, TaskSequencer
from hydrolek_drake.teleop.steps import OPENING
from hydrolek_drake.teleop.target_selection.clicks import Clicks, Task
from hydrolek_drake.vision.camera import camera_pose
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.selection import Fill
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect
from hydrolek_drake.workcell.table import make_loose_pipe, make_table

PLACES = ((1.85, 0.20), (1.95, 0.10), (1.85, -0.20))  # m, on the table
ABOVE = (0.15, 0.20)  # m above the pipe's middle: clicks on the object and the grasp


def planned(pipe, table, place: tuple[float, float], seed: int):
    frame = SimulatedKinect(pipe, np.random.default_rng(seed), table=table).read()
    clicks, pose = Clicks(frame, Task.PLACE, default_settings()), camera_pose()
    for point in (*(pipe.point + np.array([0, 0, up]) for up in ABOVE), np.array([*place, table.top[2]])):
        seen = (in_frame(point, given_in="world", wanted_in="plate") - pose[:3, 3]) @ pose[:3, :3]
        clicks.click(*frame.camera.pixel(seen), Fill.SURFACES)
    assert clicks.targets is not None and clicks.place is not None  # all has been clicked
    generator = np.random.default_rng(seed)
    return plan_place_by_either(clicks.targets, clicks.place, frame.camera, home_posture(), generator)


def carry_out(plan, arms: HydraulicArms, table) -> dict:
    """Sequencer and plant a sample at a time; set points are withdrawn as the jaw opens, as the console does."""
    sequencer = Simulator(TaskSequencer())
    system, own = sequencer.get_system(), sequencer.get_mutable_context()
    measured = arms.advance()
    system.start(own, plan, measured)
    step, withdrawn, grip, highest, ends = "", 0, [], 0.0, {}
    while system.mode(own) is Mode.RUNNING:
        system.position_measured_input.FixValue(own, measured)
        system.order_input.FixValue(own, [0.0])
        sequencer.AdvanceTo(system.one_update_on(own))
        if system.step_name(own) != step:
            ends[step] = own.get_time()
            step = system.step_name(own)
            withdrawn = 4 if step == OPENING else 0
        set_point = None if withdrawn > 0 else decode(encode(system.position_desired_output.Eval(own))).angles
        withdrawn -= 1
        measured = arms.advance(set_point)
        if step in ("lift", "carry", "lower"):
            grip.append(float(arms.grip().max()))
            pipe = make_loose_pipe(table).at(arms.pipe_place())
            highest = max(highest, pipe.lowest() - table.top[2])
    return {
        "mode": system.mode(own).name.lower(),
        "ended_in": step,
        "seconds": own.get_time(),
        "steps_ended_s": {name: seconds for name, seconds in ends.items() if name},
        "grip_N": [min(grip), max(grip)] if grip else None,
        "lifted_mm": 1e3 * highest,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--places", type=int, default=len(PLACES), help="how many of them")
    parser.add_argument("--out", type=Path, default=Path("docs/evidence/data/place_study.json"))
    parser.add_argument("--add", action="store_true", help="measure only what --out does not hold yet")
    arguments = parser.parse_args()
    logging.getLogger("drake").setLevel(logging.WARNING)
    figures = {"date": datetime.date.today().isoformat(), "seed": arguments.seed, "places": []}
    if arguments.add:
        before = read_kept(arguments.out, "what was measured before")
        if before["seed"] != arguments.seed:
            parser.error(f"{arguments.out} was measured with seed {before['seed']}, not {arguments.seed}")
        figures["places"] = before["places"]
    known = [tuple(row["place_m"]) for row in figures["places"]]
    table = make_table()
    pipe = make_loose_pipe(table)
    settings = joint_settings(load_rig("hydrolek"))
    for place in PLACES[: arguments.places]:
        if place in known:
            continue
        row: dict = {"place_m": place}
        try:
            plan = planned(pipe, table, place, arguments.seed)
            arms = HydraulicArms(
                home_posture(), seed=arguments.seed, pipe=pipe, table=table, settings=settings
            )
            row |= {"arm": plan.grasp.side, "planned_s": plan.duration()} | carry_out(plan, arms, table)
            end = pipe.at(arms.pipe_place())
            row["off_place_mm"] = 1e3 * float(np.hypot(*(end.point[:2] - place)))
            row["above_table_mm"] = 1e3 * (end.lowest() - float(table.top[2]))
            row["leaning_deg"] = float(np.degrees(np.arccos(min(1.0, abs(end.axis[2])))))
        except InputError as error:
            row["refused"] = str(error)
        figures["places"].append(row)
        print(json.dumps(row), flush=True)
        write_whole(
            arguments.out, json.dumps(figures, indent=1) + "\n"
        )  # what is measured is kept, however it ends
    print(f"figures: {arguments.out}")


if __name__ == "__main__":
    main()
