"""The Kinect on the plate between the arms, rendered by Drake: 640 x 480 px, 57 x 43 degrees."""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.geometry import (
    ClippingRange,
    ColorRenderCamera,
    DepthRange,
    DepthRenderCamera,
    RenderCameraCore,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.sensors import CameraInfo

from hydrolek_drake.vision.camera import camera_pose, thesis_camera
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.frames import Frame, FrameSource
from hydrolek_drake.vision.kinect_noise import kinect_depth
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.scene import RENDERER, Scene, home_posture, make_scene
from hydrolek_drake.workcell.table import Table

_CLIPPED = (0.05, 10.0)  # m, beyond what the sensor sees on both sides


class SimulatedKinect(FrameSource):
    """Frames of the arms and the pipe, as the arms stand.

    Attributes:
        scene: The scene that is rendered.
        brightness: Share of the light that is on; poor light darkens the picture and makes it grainy.
    """

    def __init__(
        self,
        pipe: Pipe | None,
        generator: np.random.Generator,
        *,
        brightness: float = 1.0,
        table: Table | None = None,
    ) -> None:
        self.scene: Scene = make_scene(pipe, rendered=True, table=table)
        self.brightness = brightness
        self._generator = generator
        self._context = self.scene.diagram.CreateDefaultContext()
        self.stand(home_posture())

    def stand(self, angles: ArrayLike) -> None:
        """Put joints `right_j1` ... `left_j7` at these angles in rad, shape (14,).

        Raises:
            InputError: Not 14 finite angles.
        """
        plant = self.scene.plant
        plant.SetPositions(plant.GetMyMutableContextFromRoot(self._context), self.scene.positions(angles))

    def put(self, pipe: Pipe) -> None:
        """Put the pipe of the scene elsewhere; what its sizes are stays."""
        context = self.scene.plant.GetMyMutableContextFromRoot(self._context)
        place = RigidTransform(RotationMatrix(pipe.rotation()), pipe.point)
        self.scene.pipe_frame.SetPoseInParentFrame(context, place)

    def read(self) -> Frame:
        """Render the scene and add what a Kinect adds."""
        colour, depth = self.exact()
        noisy = kinect_depth(depth, thesis_camera(), self._generator)
        return Frame(self._in_light(colour), noisy, thesis_camera(), "simulated Kinect")

    def exact(self) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
        """Colour (blue, green, red) and exact depth in m, without noise, infinite where nothing is."""
        graph = self.scene.scene_graph
        query = graph.get_query_output_port().Eval(graph.GetMyContextFromRoot(self._context))
        plate = self.scene.plant.GetBodyFrameIdOrThrow(self.scene.plant.GetBodyByName("plate").index())
        pose = RigidTransform(camera_pose())
        core = _core()
        colour = query.RenderColorImage(ColorRenderCamera(core, False), plate, pose).data
        depth = query.RenderDepthImage(DepthRenderCamera(core, DepthRange(*_CLIPPED)), plate, pose).data
        return np.ascontiguousarray(colour[:, :, 2::-1]), np.array(depth[:, :, 0], dtype=float)

    def _in_light(self, colour: NDArray[np.uint8]) -> NDArray[np.uint8]:
        if self.brightness >= 1.0:
            return colour
        # a darker picture is amplified less than it is dimmed, and its grain shows
        dimmed = colour * self.brightness + self._generator.normal(0.0, 2.0, colour.shape)
        return np.clip(dimmed.round(), 0, 255).astype(np.uint8)


def as_machine_stands(source: FrameSource, state: Any) -> None:
    """Put arms and a loose pipe where a machine has them.

    Args:
        source: A `SimulatedKinect`; any other source sees for itself.
        state: Of the machine: `position` of the joints, and `pipe` or None.
    """
    if isinstance(source, SimulatedKinect):
        source.stand(state.position)
        if state.pipe is not None:
            source.put(state.pipe)


@cache
def _core() -> RenderCameraCore:
    camera = thesis_camera()
    intrinsics = CameraInfo(
        camera.width, camera.height, camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y
    )
    near = min(_CLIPPED[0], kinect_entries("camera")["nearest"])
    return RenderCameraCore(RENDERER, intrinsics, ClippingRange(near, _CLIPPED[1]), RigidTransform())
