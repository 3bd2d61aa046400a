#!/usr/bin/env python3
"""Vision measured: intersection over union on labelled frames, and the targets' error on rendered pipes.

Writes the figures as JSON (`--out`) and prints a summary; docs/evidence/vision.md has the tables.
"""

import argparse
import datetime
import json
from pathlib import Path

import cv2
import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.vision.camera import (
    camera_pose,
    direction_to_frame,
    thesis_camera,
    thesis_target,
    to_frame,
)
from hydrolek_drake.vision.edges import default_settings, reach_mask
from hydrolek_drake.vision.frames import FolderSource
from hydrolek_drake.vision.scoring import ObjectScore, score_frame
from hydrolek_drake.vision.selection import Fill, select_object
from hydrolek_drake.vision.snapshot import take_snapshot
from hydrolek_drake.vision.targets import pipe_targets, pixel_targets
from hydrolek_drake.workcell.clutter import cluttered_frame
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect

AXES = {"vertical": (0, 0, 1), "horizontal": (0, 1, 0), "tilted": (0.2, 0.5, 1), "tilted away": (0.6, 0.1, 1)}
DISTANCES = (1.0, 1.2, 1.4)  # m from the camera
SMALLEST = 100  # px of a thing on a rendered table that have a depth within reach, or it does not count


def summary(frames: list[list[ObjectScore]]) -> dict:
    """Of all clicks: how good, how often unsure, and whether one that is wrong says so."""
    scores = [score for frame in frames for score in frame]
    clicks = [click for score in scores for click in score.clicks]
    alone = [1e3 * frame[0].middle.seconds for frame in frames]
    wrong = [click for click in clicks if click.overlap < 0.5 and not click.refused]
    first = [1e3 * score.middle.seconds for score in scores]
    return {
        "objects": len(scores),
        "clicks": len(clicks),
        "mean": float(np.mean([click.overlap for click in clicks])),
        "middle_mean": float(np.mean([score.middle.overlap for score in scores])),
        "middle_lowest": float(np.min([score.middle.overlap for score in scores])),
        "anywhere_mean": float(np.mean([score.mean_anywhere for score in scores])),
        "refused": sum(click.refused for click in clicks),
        "below_half": len(wrong),
        "below_half_without_warning": sum(not click.unsure for click in wrong),
        "below_half_but_offered": sum(click.best >= 0.5 for click in wrong),
        "warned": float(np.mean([click.unsure for click in clicks])),
        "warned_above_0.8": float(np.mean([click.unsure and click.overlap > 0.8 for click in clicks])),
        "first_click_in_frame_processor_ms_median": float(np.median(alone)),
        "first_click_in_frame_processor_ms_90_percent": float(np.percentile(alone, 90)),
        "first_click_processor_ms_median": float(np.median(first)),
        "first_click_processor_ms_90_percent": float(np.percentile(first, 90)),
    }


def score_recorded(folder: Path, seed: int) -> dict:
    source, result = FolderSource(folder), {}
    labels = cv2.imread(str(folder / f"{source.names[0]}_label.png"), cv2.IMREAD_UNCHANGED)
    score_frame(
        source.named(source.names[0]), labels, default_settings(), np.random.default_rng(seed), clicks=1
    )
    for fill in Fill:  # compiled and loaded by now
        generator, scores, times = np.random.default_rng(seed), [], []
        for name in source.names:
            labels = cv2.imread(str(folder / f"{name}_label.png"), cv2.IMREAD_UNCHANGED)
            labels = np.where(labels < 20, 0, labels).astype(np.uint8)  # 1 is the table
            found, _ = score_frame(source.named(name), labels, default_settings(), generator, fill=fill)
            _, seconds = score_frame(source.named(name), labels, default_settings(), generator, clicks=1)
            scores.append(found)
            times.append(seconds)
        result[fill.value] = summary(scores) | {
            "frame_processor_ms_mean": 1e3 * float(np.mean(times)),
            "frame_processor_ms_median": 1e3 * float(np.median(times)),
        }
    return result


def score_clutter(first: int, last: int) -> dict:
    """Rendered tables of these seeds; 3 clicks anywhere in each thing that is seen, and one in its middle."""
    scores, worst = [], []
    for seed in range(first, last + 1):
        generator = np.random.default_rng(seed)
        shown = cluttered_frame(generator)
        labels = np.where(reach_mask(shown.frame.depth, default_settings()), shown.labels, 0).astype(np.uint8)
        found, _ = score_frame(shown.frame, labels, default_settings(), generator, clicks=3, least=SMALLEST)
        scores.append(found)
        for score in found:
            for click in score.clicks:
                if click.overlap < 0.5 and not click.unsure:
                    worst.append({"seed": seed, "thing": shown.kinds[score.number - 1], **vars(click)})
    return {"seeds": [first, last]} | summary(scores) | {"below_half_or_refused_without_warning": worst}


def in_camera(point: np.ndarray) -> np.ndarray:
    pose = camera_pose()
    return (in_frame(point, given_in="world", wanted_in="plate") - pose[:3, 3]) @ pose[:3, :3]


def score_rendered(seed: int) -> list[dict]:
    rows = []
    for brightness in (1.0, 0.1):
        for name, axis in AXES.items():
            for distance in DISTANCES:
                middle = in_frame([0.15 + distance, 0.0, 0.24], given_in="plate", wanted_in="world")
                pipe = make_pipe(middle, axis)
                kinect = SimulatedKinect(pipe, np.random.default_rng(seed), brightness=brightness)
                row = {"pipe": name, "distance_m": distance, "brightness": brightness}
                rows.append(row | targets_of(kinect, pipe))
    return rows


def targets_of(kinect: SimulatedKinect, pipe) -> dict:
    frame, camera = kinect.read(), thesis_camera()
    snapshot = take_snapshot(frame.colour, frame.depth, camera, default_settings())
    wanted = pipe.point + 0.1 * pipe.axis
    clicks = [camera.pixel(in_camera(point)) for point in (wanted, pipe.point - 0.1 * pipe.axis)]
    try:
        selected = select_object(snapshot, tuple(clicks[0])).mask
        pixels = pixel_targets(snapshot, selected, *clicks, camera)
        targets = pipe_targets(snapshot, selected, pixels, camera)
    except InputError as error:
        return {"refused": str(error)}
    bare = SimulatedKinect(None, np.random.default_rng(0))
    true = np.abs(kinect.exact()[1] - bare.exact()[1]) > 0.01
    error = to_frame(targets.grasp, "world") - wanted
    axis = direction_to_frame(targets.cylinder.axis, "world")
    printed = thesis_target(pixels.grasp, pixels.grasp_depth) - [0.275, 0.0, 0.0]
    return {
        "overlap": float((selected & true).sum() / (selected | true).sum()),
        "grasp_error_mm": 1e3 * float(np.linalg.norm(error)),
        "off_axis_mm": 1e3 * float(np.linalg.norm(error - (error @ pipe.axis) * pipe.axis)),
        "axis_error_deg": float(np.degrees(np.arccos(min(1.0, abs(axis @ pipe.axis))))),
        "radius_error_mm": 1e3 * (targets.cylinder.radius - pipe.radius),
        "printed_5_2_error_mm": 1e3 * float(np.linalg.norm(printed - in_camera(wanted))),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "folder", type=Path, nargs="?", help="frames NAME_color.png, NAME_depth.png, NAME_label.png"
    )
    parser.add_argument(
        "--clutter", type=int, nargs=2, metavar=("FIRST", "LAST"), help="seeds of rendered tables"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("docs/evidence/data/vision.json"))
    arguments = parser.parse_args()
    if (arguments.folder is None) == (arguments.clutter is None):
        parser.error("give a folder of labelled frames, or --clutter FIRST LAST")
    cv2.setNumThreads(1)  # processor time is what is given; waiting threads count in it
    figures = json.loads(arguments.out.read_text()) if arguments.out.exists() else {}
    if arguments.clutter is not None:
        row = score_clutter(*arguments.clutter)
        figures.setdefault("clutter", {})["{} to {}".format(*arguments.clutter)] = row
        print(json.dumps(row, indent=1))
    else:
        figures |= {"seed": arguments.seed, "recorded": score_recorded(arguments.folder, arguments.seed)}
        for fill, row in figures["recorded"].items():
            print(fill, row)
        figures["rendered"] = score_rendered(arguments.seed)
        for row in figures["rendered"]:
            print(row)
    figures["date"] = datetime.date.today().isoformat()
    write_whole(arguments.out, json.dumps(figures, indent=1) + "\n")
    print(f"figures: {arguments.out}")


if __name__ == "__main__":
    main()
