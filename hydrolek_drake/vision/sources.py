"""A camera by the name that a user gives it."""

from pathlib import Path

from hydrolek_drake.vision.frames import FolderSource, FrameSource, LiveCamera
from hydrolek_drake.vision.realsense import RECORDINGS, RealSenseCamera


def camera_source(name: str, *, flipped: bool = False) -> FrameSource:
    """A live camera or recorded frames.

    Args:
        name: `live`, `realsense`, a recording of a RealSense camera, or a folder of frames.
        flipped: Mirror a live camera's pictures back.

    Raises:
        InputError: It is not there, with the reason.
    """
    if name == "live":
        return LiveCamera(flipped=flipped)
    if name == "realsense":
        return RealSenseCamera(flipped=flipped)
    if name.endswith(RECORDINGS):
        return RealSenseCamera(Path(name), flipped=flipped)
    return FolderSource(Path(name))
