"""Where frames come from: a folder, a live camera, or the simulated Kinect; all give the same frame."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.camera import CameraModel, checked_frame, recorded_camera


@dataclass(frozen=True)
class Frame:
    """One picture with its depth, aligned with each other.

    Attributes:
        colour: Blue, green, red, shape (h, w, 3).
        depth: In mm along the optical axis, 0 for no reading, shape (h, w).
        camera: Its intrinsics.
        name: Where it comes from, for messages.
    """

    colour: NDArray[np.uint8]
    depth: NDArray[np.uint16]
    camera: CameraModel
    name: str


class FrameSource(ABC):
    """Something that gives frames."""

    @abstractmethod
    def read(self) -> Frame:
        """The next frame.

        Raises:
            InputError: There is none, with the reason.
        """

    def close(self) -> None:
        """Let go what is held; nothing by default."""
        return


class FolderSource(FrameSource):
    """Frames `NAME_color.png` with `NAME_depth.png` of a folder, in the order of their names, again and again."""

    def __init__(self, folder: Path, camera: CameraModel | None = None) -> None:
        if not folder.is_dir():
            raise InputError(f"{folder} is not a folder; give one with NAME_color.png and NAME_depth.png")
        self.names = sorted(path.name.removesuffix("_color.png") for path in folder.glob("*_color.png"))
        if not self.names:
            raise InputError(f"{folder} holds no NAME_color.png; a frame is such a file with NAME_depth.png")
        self._folder, self._camera, self._next = folder, camera or recorded_camera(), 0

    def read(self) -> Frame:
        """The next frame of the folder; after the last comes the first."""
        name = self.names[self._next]
        self._next = (self._next + 1) % len(self.names)
        return self.named(name)

    def named(self, name: str) -> Frame:
        """One frame by its name.

        Raises:
            InputError: It does not exist, cannot be read, or is not the camera's size and type.
        """
        if name not in self.names:
            raise InputError(f"{self._folder} has no frame '{name}'; choose from {', '.join(self.names)}")
        colour = cv2.imread(str(self._folder / f"{name}_color.png"), cv2.IMREAD_COLOR)
        depth = cv2.imread(str(self._folder / f"{name}_depth.png"), cv2.IMREAD_UNCHANGED)
        for part, picture in (("color", colour), ("depth", depth)):
            if picture is None:
                raise InputError(f"{self._folder / f'{name}_{part}.png'} is missing or is no picture")
        try:
            checked_frame(colour, depth, self._camera)
        except InputError as error:
            raise InputError(f"{self._folder / name}: {error}") from None
        return Frame(colour, depth, self._camera, name)


class LiveCamera(FrameSource):
    """A Kinect or another OpenNI camera through OpenCV, with the depth registered onto the colour."""

    def __init__(self, index: int = 0, *, flipped: bool = False, camera: CameraModel | None = None) -> None:
        self._capture = cv2.VideoCapture(cv2.CAP_OPENNI2 + index)
        if not self._capture.isOpened():
            raise InputError(
                f"no depth camera {index} answers through OpenCV's OpenNI2; connect one, with an OpenCV that is "
                "built with OpenNI2 (cv2.getBuildInformation() says so), or use sim or a folder"
            )
        self._capture.set(cv2.CAP_PROP_OPENNI_REGISTRATION, 1)
        self._flipped, self._camera, self._index = flipped, camera or recorded_camera(), index

    def read(self) -> Frame:
        """The newest frame; mirrored back if the driver mirrors it (5.2.2)."""
        grabbed = self._capture.grab()
        got_depth, depth = self._capture.retrieve(flag=cv2.CAP_OPENNI_DEPTH_MAP)
        got_colour, colour = self._capture.retrieve(flag=cv2.CAP_OPENNI_BGR_IMAGE)
        if not (grabbed and got_depth and got_colour):
            raise InputError(f"camera {self._index} gives no more frames; check its cable and power")
        if self._flipped:
            colour, depth = flipped(colour), flipped(depth)
        checked_frame(colour, depth, self._camera)
        return Frame(colour, depth, self._camera, f"camera {self._index}")

    def close(self) -> None:
        """Let the camera go."""
        self._capture.release()


def flipped(picture: NDArray) -> NDArray:
    """The picture mirrored left to right, contiguous in memory."""
    return np.ascontiguousarray(picture[:, ::-1])


def aligned_depth(
    depth: NDArray[np.uint16],
    depth_camera: CameraModel,
    colour_camera: CameraModel,
    colour_from_depth: NDArray[np.float64],
) -> NDArray[np.uint16]:
    """Depth as seen from the colour camera, for sensors whose driver does not register them (5.2.2).

    Args:
        depth: In mm from the depth camera, 0 for no reading, shape (h, w).
        depth_camera: Intrinsics of the depth camera.
        colour_camera: Intrinsics of the colour camera.
        colour_from_depth: Pose of the depth camera in the colour camera's frame, shape (4, 4), in m.

    Returns:
        Depth in mm along the colour camera's axis, shape of the colour picture; the nearest where several points
        fall onto one pixel, 0 where none does.
    """
    rows, columns = np.nonzero(depth)
    points = depth_camera.point(np.column_stack([columns, rows]), depth[rows, columns] * 1e-3)
    points = points @ colour_from_depth[:3, :3].T + colour_from_depth[:3, 3]
    points = points[points[:, 2] > 0.0]
    u, v = np.round(colour_camera.pixel(points)).astype(int).T
    inside = (u >= 0) & (u < colour_camera.width) & (v >= 0) & (v < colour_camera.height)
    u, v, z = u[inside], v[inside], points[inside, 2]
    seen = np.full((colour_camera.height, colour_camera.width), np.inf)
    np.minimum.at(seen, (v, u), z)
    return np.where(np.isfinite(seen), np.round(1e3 * seen), 0).astype(np.uint16)
