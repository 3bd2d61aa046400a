"""`hydrolek vision`: one frame's edges, the object under a click, and the targets on it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hydrolek_drake.vision.camera import CameraModel
    from hydrolek_drake.vision.frames import FrameSource
    from hydrolek_drake.vision.selection import Mask, Snapshot

_CAMERAS = "sim, live (OpenNI), realsense, a recording of one (.db3), or a folder of frames"
_Pixel = tuple[float, float]


def vision(
    source: Annotated[str, typer.Argument(metavar="SOURCE", help=_CAMERAS)],
    click: Annotated[_Pixel | None, typer.Option(metavar="U V", help="pixel inside the object")] = None,
    grasp: Annotated[_Pixel | None, typer.Option(metavar="U V", help="pixel to grasp at")] = None,
    cut: Annotated[_Pixel | None, typer.Option(metavar="U V", help="pixel to cut at")] = None,
    other: Annotated[
        int, typer.Option(min=0, metavar="N", help="take the Nth other outline, where the object is unsure")
    ] = 0,
    frame: Annotated[
        str | None, typer.Option(help="name of a frame of the folder; the first if not given")
    ] = None,
    fill: Annotated[str, typer.Option(help="surfaces, or edges as in the thesis")] = "surfaces",
    low_contrast: Annotated[float | None, typer.Option(help="slider, 0 to 1")] = None,
    high_contrast: Annotated[float | None, typer.Option(help="slider, 0 to 1")] = None,
    sensitivity: Annotated[float | None, typer.Option(help="slider, 0 to 1")] = None,
    flip: Annotated[bool, typer.Option(help="mirror a live camera's pictures back")] = False,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="folder for the pictures")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the simulated camera's noise")] = 1,
) -> None:
    """Take a snapshot, select the object under a click, and compute where to grasp and cut it."""
    from dataclasses import replace

    import cv2
    import numpy as np

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.files import write_results
    from hydrolek_drake.vision.edges import default_settings
    from hydrolek_drake.vision.frames import FolderSource
    from hydrolek_drake.vision.selection import Fill, overlay, select_object
    from hydrolek_drake.vision.snapshot import take_snapshot

    if fill not in [each.value for each in Fill]:
        raise InputError(f"vision: --fill '{fill}' is unknown; choose from surfaces, edges")
    if (grasp is None) != (cut is None) or (grasp is not None and click is None):
        raise InputError("vision: give --click, --grasp and --cut together, or --click alone, or none")
    sliders = {"low_contrast": low_contrast, "high_contrast": high_contrast, "sensitivity": sensitivity}
    given = {name: value for name, value in sliders.items() if value is not None}
    settings = replace(default_settings(), **given)
    frames = _source(source, seed, flip)
    if frame is not None:
        if not isinstance(frames, FolderSource):
            raise InputError("vision: --frame names a frame of a folder; leave it out")
        taken = frames.named(frame)
    else:
        taken = frames.read()
    snapshot = take_snapshot(taken.colour, taken.depth, taken.camera, settings)
    pictures = {"colour": taken.colour, "edges": snapshot.edges}
    lines = [f"{taken.name}: {100 * snapshot.mask.mean():.0f} % of the picture is within reach"]
    if click is not None:
        selection = select_object(snapshot, click, Fill(fill))
        if other > len(selection.alternatives):
            count = len(selection.alternatives)
            raise InputError(
                f"vision: --other {other}, but this click has {count} other outline{'' if count == 1 else 's'}"
            )
        for _ in range(other):
            selection = selection.next()
        selected = selection.mask
        pictures["object"], pictures["selected"] = (
            (selected * 255).astype(np.uint8),
            overlay(taken.colour, selected),
        )
        lines.append(f"object: {int(selected.sum())} px")
        if selection.unsure:
            lines.append(selection.warning)
        for number, mask in enumerate(selection.alternatives if selection.unsure and other == 0 else (), 1):
            lines.append(f"other outline: {int(mask.sum())} px (--other {number})")
            pictures[f"other{number}"] = overlay(taken.colour, mask)
        if grasp is not None and cut is not None:
            lines += _targets(snapshot, selected, grasp, cut, taken.camera, pictures["selected"])
    if out is not None:
        write_results(
            out, {f"{name}.png": cv2.imencode(".png", each)[1].tobytes() for name, each in pictures.items()}
        )
        lines.append(f"pictures: {out}")
    for line in lines:
        console().print(line, markup=False, soft_wrap=True)


def _source(source: str, seed: int, flip: bool) -> "FrameSource":
    import numpy as np

    from hydrolek_drake.vision.sources import camera_source

    if source == "sim":
        from hydrolek_drake.workcell.pipe import make_pipe
        from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect

        return SimulatedKinect(make_pipe(), np.random.default_rng(seed))
    return camera_source(source, flipped=flip)


def _targets(
    snapshot: "Snapshot",
    selected: "Mask",
    grasp: _Pixel,
    cut: _Pixel,
    camera: "CameraModel",
    picture: "NDArray[Any]",
) -> list[str]:
    import cv2
    import numpy as np

    from hydrolek_drake.vision.camera import thesis_target, to_frame
    from hydrolek_drake.vision.targets import pipe_targets, pixel_targets

    def millimetres(point: "NDArray[Any]") -> str:
        return "(" + ", ".join(f"{1e3 * value:.1f}" for value in point) + ") mm"

    pixels = pixel_targets(snapshot, selected, grasp, cut, camera)
    for start, end, colour in ((*pixels.line.ends, (0, 200, 255)), (*pixels.cut_ends, (255, 0, 255))):
        cv2.line(picture, *(tuple(int(x) for x in np.round(p)) for p in (start, end)), colour, 2)
    cv2.circle(picture, tuple(int(x) for x in np.round(pixels.grasp)), 6, (0, 255, 0), 2)
    lines = [
        f"centre line: {np.degrees(pixels.line.orientation):.1f} deg, "
        f"{pixels.line.length:.0f} x {pixels.line.width:.0f} px",
        f"grasp by (5.2) as printed: {millimetres(thesis_target(pixels.grasp, pixels.grasp_depth))}",
    ]
    targets = pipe_targets(snapshot, selected, pixels, camera)
    lines.append(
        f"pipe: radius {1e3 * targets.cylinder.radius:.1f} mm, "
        f"depth points {1e3 * targets.cylinder.residual:.1f} mm rms off it"
    )
    for name, point in (
        ("grasp", targets.grasp),
        ("approach", targets.approach),
        ("cut start", targets.cut_start),
        ("cut end", targets.cut_end),
    ):
        lines.append(
            f"{name}: {millimetres(to_frame(point, 'right_base'))} in right_base, "
            f"{millimetres(to_frame(point, 'left_base'))} in left_base"
        )
    return lines
