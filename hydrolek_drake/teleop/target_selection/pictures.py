"""The pictures that the console shows, as JPEG, and whether they have changed."""

import cv2
import numpy as np
from numpy.typing import NDArray

_QUALITY = [cv2.IMWRITE_JPEG_QUALITY, 85]


class Pictures:
    """Named pictures. Not for several threads at a time.

    Attributes:
        version: Grows whenever a picture, or which one is to be shown, has changed.
    """

    def __init__(self) -> None:
        self._kept: dict[str, bytes] = {}
        self.version = 0

    def show(self, name: str, picture: NDArray[np.uint8]) -> None:
        """Keep a picture, blue, green and red, shape (height, width, 3); one that cannot be coded is left out."""
        done, data = cv2.imencode(".jpg", picture, _QUALITY)
        if done:
            self._kept[name] = data.tobytes()
            self.changed()

    def drop(self, name: str) -> None:
        """Forget a picture."""
        self._kept.pop(name, None)
        self.changed()

    def jpeg(self, name: str) -> bytes:
        """The picture, empty where there is none."""
        return self._kept.get(name, b"")

    def changed(self) -> None:
        """Another picture is to be shown."""
        self.version += 1
