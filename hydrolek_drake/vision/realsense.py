"""An Intel RealSense camera through librealsense, or what one has recorded, played through the same code."""

import contextlib
import ctypes
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.camera import CameraModel, checked_frame
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.frames import Frame, FrameSource, flipped

RECORDINGS = (".db3", ".bag")
"""How the names of librealsense's recordings end; newer versions write the first."""

_MILLIMETRE = 1e-3  # m


class RealSenseCamera(FrameSource):
    """A RealSense camera with the depth aligned onto the colour.

    The first one that answers, or a recording of one, which librealsense plays through the same pipeline. A lens's
    distortion is left in.

    Args:
        recording: What to play instead of a camera, if given.
        flipped: Mirror the pictures back (5.2.2).
        again: Begin a recording again when it has ended; without it the camera is lost then.

    Raises:
        InputError: The package is not installed, or no camera answers, or the recording cannot be played.
    """

    def __init__(self, recording: Path | None = None, *, flipped: bool = False, again: bool = True) -> None:
        self._library = librealsense()
        self._recording, self._flipped, self._again = recording, flipped, again
        self._what = "the RealSense camera" if recording is None else f"{recording}"
        self._pipeline: Any = None
        self._start()

    def read(self) -> Frame:
        """The newest frame. After a camera was lost, the next call looks for one again.

        Raises:
            InputError: The camera gives no more frames, or what is no picture and depth of one size.
        """
        if self._pipeline is None:
            self._start()
        try:
            try:
                frames = self._newest()
            except RuntimeError:
                if self._recording is None or not self._again:
                    raise
                self.close()  # it has ended: from its beginning
                self._start()
                frames = self._newest()
            if not self._aligned:
                frames = self._align.process(frames)
            colour, depth = frames.get_color_frame(), frames.get_depth_frame()
            if not colour or not depth:
                raise RuntimeError("a frame without colour or depth")
            pictures = self._blue_green_red(colour), _in_millimetres(depth)
            camera = _model(colour.profile.as_video_stream_profile().get_intrinsics())
        except RuntimeError as error:
            self.close()
            advice = "check its cable and power" if self._recording is None else "it has ended"
            raise InputError(f"{self._what} gives no more frames ({_in_one_line(error)}); {advice}") from None
        if self._flipped:
            pictures = flipped(pictures[0]), flipped(pictures[1])
        checked_frame(*pictures, camera)
        return Frame(*pictures, camera, self._what)

    def close(self) -> None:
        """Let the camera go."""
        pipeline, self._pipeline = self._pipeline, None
        if pipeline is not None:
            with contextlib.suppress(RuntimeError):  # it is lost already
                pipeline.stop()

    def _start(self) -> None:
        library = self._library
        if self._recording is None and not len(library.context().query_devices()):
            raise InputError(
                "no RealSense camera answers; connect one (USB 3), or use sim, live, a recording or a folder"
            )
        if self._recording is not None and not self._recording.is_file():
            raise InputError(f"{self._recording} does not exist; give a recording of a RealSense camera")
        config, pipeline = library.config(), library.pipeline()
        try:
            if self._recording is not None:
                config.enable_device_from_file(str(self._recording), repeat_playback=False)
                config.enable_stream(library.stream.depth)
                config.enable_stream(library.stream.color)  # as it was recorded
            else:
                values = kinect_entries("camera")
                size = int(values["width"]), int(values["height"])
                config.enable_stream(library.stream.depth, *size, library.format.z16, _PICTURES_A_SECOND)
                config.enable_stream(library.stream.color, *size, library.format.bgr8, _PICTURES_A_SECOND)
            if self._recording is not None:  # frame by frame, however slowly it is read
                config.resolve(library.pipeline_wrapper(pipeline)).get_device().as_playback().set_real_time(
                    False
                )
            started = pipeline.start(config)
        except RuntimeError as error:
            raise InputError(f"{self._what} cannot be started: {_in_one_line(error)}") from None
        self._pipeline, self._align, self._seen = pipeline, library.align(library.stream.color), False
        depth, colour = (
            started.get_stream(stream).as_video_stream_profile()
            for stream in (library.stream.depth, library.stream.color)
        )
        self._aligned = _seen_from_one_place(depth, colour)

    def _blue_green_red(self, colour: Any) -> NDArray[np.uint8]:
        """A copy of the colour picture, which recordings hold in several forms."""
        form, picture = colour.profile.format(), np.array(colour.get_data())
        if form == self._library.format.bgr8:
            return picture
        if form == self._library.format.rgb8:
            return np.ascontiguousarray(picture[:, :, ::-1])
        raise InputError(f"{self._what} holds colour as {form.name}; record it as rgb8 or bgr8")

    def _newest(self) -> Any:
        patience = kinect_entries("camera")["patience" if self._seen or self._recording else "start"]
        frames = self._pipeline.wait_for_frames(round(1e3 * patience))
        self._seen = True
        return frames


_PICTURES_A_SECOND = 30  # what every model gives at 640 x 480


def _in_millimetres(depth: Any) -> NDArray[np.uint16]:
    """Depth in mm, whatever the camera counts in."""
    counted = np.array(depth.get_data())
    unit = depth.get_units()
    if abs(unit - _MILLIMETRE) < 1e-3 * _MILLIMETRE:
        return counted
    return np.clip(np.round(counted * (unit / _MILLIMETRE)), 0, np.iinfo(np.uint16).max).astype(np.uint16)


def _model(intrinsics: Any) -> CameraModel:
    return CameraModel(
        intrinsics.width, intrinsics.height, intrinsics.fx, intrinsics.fy, intrinsics.ppx, intrinsics.ppy
    )


def _seen_from_one_place(depth: Any, colour: Any) -> bool:
    """Whether both pictures come from one camera, so that aligning them would only add its roundings."""
    pose = depth.get_extrinsics_to(colour)
    still = np.allclose(pose.rotation, np.eye(3).ravel()) and np.allclose(pose.translation, 0.0)
    return still and _model(depth.get_intrinsics()) == _model(colour.get_intrinsics())


def _in_one_line(error: Exception) -> str:
    return " ".join(str(error).split())


def librealsense() -> Any:
    """The package `pyrealsense2`, which is an optional one.

    Raises:
        InputError: It is not installed, or cannot be loaded.
    """
    with contextlib.suppress(ImportError, OSError):  # where the system has libusb, this package need not be
        libusb = import_module("libusb_package").get_library_path()
        ctypes.CDLL(str(libusb), mode=ctypes.RTLD_GLOBAL)
    try:
        return import_module("pyrealsense2")
    except ModuleNotFoundError:
        raise InputError(
            "a RealSense camera needs the package pyrealsense2: pip install 'hydrolek-drake[realsense]'"
        ) from None
    except ImportError as error:
        raise InputError(f"the package pyrealsense2 cannot be loaded: {_in_one_line(error)}") from None
