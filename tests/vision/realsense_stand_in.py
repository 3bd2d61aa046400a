"""A recording as a RealSense camera makes it, from frames, so that no camera is needed to play it."""

import contextlib
import time

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.realsense import librealsense

_PERIOD = 1.0 / 30.0  # s, between pictures
_WRITTEN = 0.03  # s that the recorder is given for a frame before the next, or it may drop one

missing = ""
try:
    rs = librealsense()
except InputError as error:
    missing = str(error)


def record(path, frames, *, unit=1e-3, baseline=0.0, form="bgr8"):
    """Write frames as a camera would whose depth counts in `unit` m, from `baseline` m to the right of the colour."""
    device = rs.software_device()
    depth_sensor, colour_sensor = device.add_sensor("Depth"), device.add_sensor("Color")
    depth_sensor.add_read_only_option(rs.option.depth_units, unit)
    camera = frames[0].camera
    depth = depth_sensor.add_video_stream(_stream(rs.stream.depth, 0, rs.format.z16, 2, camera))
    colour = colour_sensor.add_video_stream(_stream(rs.stream.color, 1, getattr(rs.format, form), 3, camera))
    pose = rs.extrinsics()
    pose.rotation, pose.translation = np.eye(3).ravel().tolist(), [baseline, 0.0, 0.0]
    depth.register_extrinsics_to(colour, pose)
    recorder = rs.recorder(str(path), device)
    sensors = recorder.query_sensors()
    for sensor in sensors:
        sensor.open(sensor.get_stream_profiles()[0])
        sensor.start(lambda _: None)
    for number, frame in enumerate(frames):
        counted = np.round(frame.depth * (1e-3 / unit)).astype(np.uint16)
        seen = frame.colour if form == "bgr8" else np.ascontiguousarray(frame.colour[:, :, ::-1])
        for sensor, profile, picture in (
            (depth_sensor, depth, counted),
            (colour_sensor, colour, seen),
        ):
            sent = rs.software_video_frame()
            sent.pixels, sent.bpp = picture, picture.itemsize * (picture.shape[2] if picture.ndim == 3 else 1)
            sent.stride = sent.bpp * picture.shape[1]
            sent.timestamp, sent.frame_number = 1e3 * _PERIOD * number, number + 1
            sent.domain, sent.profile = rs.timestamp_domain.hardware_clock, profile.as_video_stream_profile()
            if sensor is depth_sensor:
                sent.depth_units = unit
            sensor.on_video_frame(sent)
        time.sleep(_WRITTEN)
    for sensor in sensors:
        with contextlib.suppress(RuntimeError):
            sensor.stop()
            sensor.close()
    del recorder  # which writes the file's end


def _stream(kind, number, form, size, camera):
    stream = rs.video_stream()
    stream.type, stream.uid, stream.fmt, stream.bpp, stream.fps = kind, number, form, size, 30
    stream.width, stream.height = camera.width, camera.height
    lens = rs.intrinsics()
    lens.width, lens.height, lens.fx, lens.fy = camera.width, camera.height, camera.focal_x, camera.focal_y
    lens.ppx, lens.ppy, lens.model, lens.coeffs = (
        camera.centre_x,
        camera.centre_y,
        rs.distortion.none,
        [0.0] * 5,
    )
    stream.intrinsics = lens
    return stream
