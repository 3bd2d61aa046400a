"""A saved run of the arms as an animation, drawn from joint angles and the URDF alone.

No multibody plant and no diagram is built: link poses come from the URDF's tree, cylinders lie between their
mounts. Shown with the meshcat package.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import meshcat
import meshcat.animation
import meshcat.geometry
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.visualization.urdf_tree import TreeCylinder, UrdfTree, arm_cylinders, arms_tree

Array = NDArray[np.float64]

FRAMES_PER_SECOND = 30

# Composition of the picture, not physics.
_EYE, _TARGET = np.array([2.6, -1.7, 1.6]), np.array([1.05, 0.0, 0.7])
_BARREL_COLOUR, _ROD_COLOUR = (0.20, 0.21, 0.24, 1.0), (0.85, 0.86, 0.88, 1.0)
_BACKGROUND = [[0.86, 0.90, 0.94], [0.97, 0.98, 0.99]]
_STILL = 1e-9  # m and parts of a turn


@dataclass(frozen=True)
class SavedRun:
    """Joint angles over time.

    Attributes:
        source: file that they came from.
        time: of the frames, from 0 [s], shape (n,).
        angles: of every moving joint of the arms [rad], shape (n,) each.
    """

    source: Path
    time: Array
    angles: dict[str, Array]


def read_saved_run(path: Path) -> SavedRun:
    """Read a folder that `hydrolek simulate --out` wrote, or any recording with angles of the arms' joints.

    Joints without a signal stand where `run.json` beside the file holds them, or where the rig `hydrolek`
    begins.

    Raises:
        InputError: no such file, or no angle of a joint of the arms in it.
    """
    file = path / "signals.parquet" if path.is_dir() else path
    recording = read_recording(file)
    names = arms_tree().moving()
    posture = _posture(file.parent / "run.json", names)
    begin, end = float(recording.time[0]), float(recording.time[-1])
    time = np.arange(begin, end, 1.0 / FRAMES_PER_SECOND)
    angles = {}
    for name in names:
        values = recording.signals.get(f"{name}.angle")
        if values is None or not np.isfinite(values).any():
            angles[name] = np.full(time.shape, posture[name])
        else:
            finite = np.isfinite(values)
            angles[name] = np.interp(time, recording.time[finite], values[finite])
    if not any(f"{name}.angle" in recording.signals for name in names):
        raise InputError(
            f"{file} has no angle of a joint of the arms; name a column {names[0]}.angle_deg; "
            f"joints are {', '.join(names)}"
        )
    return SavedRun(file, time - begin, angles)


def draw_saved_run(run: SavedRun, view: meshcat.Visualizer) -> None:
    """Draw the arms in a meshcat view and give it the run as an animation with a time slider."""
    tree, cylinders = arms_tree(), arm_cylinders()
    view.delete()
    nodes = _draw_links(view["arms"], tree) | _draw_cylinders(view["cylinders"], cylinders)
    poses = _poses(run, tree, cylinders)
    animation = meshcat.animation.Animation(default_framerate=FRAMES_PER_SECOND)
    for name, node in nodes.items():
        node.set_transform(poses[name][0])
    moving = [name for name in nodes if np.abs(poses[name] - poses[name][0]).max() > _STILL]
    for frame in range(len(run.time)):
        for name in moving:
            with animation.at_frame(nodes[name], frame) as at:
                at.set_transform(poses[name][frame])
    if moving:
        view.set_animation(animation, play=True, repetitions=1)
    view["/Cameras/default"].set_transform(meshcat.transformations.translation_matrix(_TARGET))
    across, left, up = _EYE - _TARGET
    # the camera's own frame has y upwards
    view["/Cameras/default/rotated/<object>"].set_property("position", [across, up, -left])
    view["/Axes"].set_property("visible", False)
    for where, colour in zip(("top_color", "bottom_color"), _BACKGROUND, strict=True):
        view["/Background"].set_property(where, colour)


def _poses(run: SavedRun, tree: UrdfTree, cylinders: tuple[TreeCylinder, ...]) -> dict[str, Array]:
    """World poses of links, barrels and rods, shape (frames, 4, 4) each."""
    frames: dict[str, list[Array]] = {}
    for row in range(len(run.time)):
        links = tree.link_poses({name: float(values[row]) for name, values in run.angles.items()})
        for link, pose in links.items():
            frames.setdefault(link, []).append(pose)
        for cylinder in cylinders:
            start = (links[cylinder.parent] @ np.append(cylinder.p_parent, 1.0))[:3]
            end = (links[cylinder.child] @ np.append(cylinder.p_child, 1.0))[:3]
            frames.setdefault(f"{cylinder.joint}_barrel", []).append(_pointing(start, end - start))
            frames.setdefault(f"{cylinder.joint}_rod", []).append(_pointing(end, start - end))
    return {name: np.array(poses) for name, poses in frames.items()}


def _draw_links(view: Any, tree: UrdfTree) -> dict[str, Any]:
    nodes = {}
    for link, shapes in tree.shapes.items():
        for number, shape in enumerate(shapes):
            node = view[link][str(number)]
            if shape.kind == "box":
                node.set_object(meshcat.geometry.Box(list(shape.size)), _material(shape.colour))
                node.set_transform(shape.pose)
            else:
                radius, length = shape.size
                _draw_cylinder(node, radius, length, shape.pose, shape.colour)
        if shapes:
            nodes[link] = view[link]
    return nodes


def _draw_cylinders(view: Any, cylinders: tuple[TreeCylinder, ...]) -> dict[str, Any]:
    nodes = {}
    for cylinder in cylinders:
        # the barrel ends short of the closed length, so that the rod shows even when it is in
        for part, radius, length, colour in (
            ("barrel", cylinder.barrel_radius, 0.84 * cylinder.closed_length, _BARREL_COLOUR),
            ("rod", cylinder.rod_radius, 0.96 * cylinder.closed_length, _ROD_COLOUR),
        ):
            name = f"{cylinder.joint}_{part}"
            middle = np.eye(4)
            middle[2, 3] = length / 2.0
            _draw_cylinder(view[name]["tube"], radius, length, middle, colour)
            view[name]["eye"].set_object(
                meshcat.geometry.Sphere(1.2 * cylinder.rod_radius), _material(colour)
            )
            nodes[name] = view[name]
    return nodes


def _draw_cylinder(node: Any, radius: float, length: float, pose: Array, colour: tuple[float, ...]) -> None:
    """A cylinder along z; meshcat's own lies along y."""
    upright = np.eye(4)
    upright[:3, :3] = Rotation.from_euler("x", np.pi / 2.0).as_matrix()
    node.set_object(meshcat.geometry.Cylinder(length, radius), _material(colour))
    node.set_transform(pose @ upright)


def _material(colour: tuple[float, ...]) -> Any:
    red, green, blue = (round(255 * part) for part in colour[:3])
    return meshcat.geometry.MeshPhongMaterial(
        color=red * 0x10000 + green * 0x100 + blue, opacity=colour[3], transparent=colour[3] < 1.0
    )


def _pointing(origin: Array, direction: Array) -> Array:
    """Pose at `origin` with z along `direction`; its x stays as level as it can, so it does not spin."""
    z = direction / np.linalg.norm(direction)
    x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    pose[:3, 3] = origin
    return pose


def _posture(beside: Path, names: tuple[str, ...]) -> Mapping[str, float]:
    rig = load_rig("hydrolek")
    posture = {name: rig.value(f"joints.{name}.load.initial_position") for name in names}
    try:
        held = json.loads(beside.read_text(encoding="utf-8"))["held"]
        posture.update({str(name): float(angle) for name, angle in held.items()})
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return posture  # a recording of another origin has no such file
    return posture
