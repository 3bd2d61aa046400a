"""A frame source in a thread of its own, as a renderer must live and end in one thread."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from hydrolek_drake.vision.frames import Frame, FrameSource


class CameraThread:
    """Makes, reads and ends a frame source in one thread.

    Args:
        source: Makes the source.
        before: Called with it before each frame.
    """

    def __init__(self, source: Callable[[], FrameSource], before: Callable[[FrameSource], None]) -> None:
        self._before = before
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="camera")
        self._thread.submit(self._begin, source).result()

    def read(self) -> Frame:
        """The next frame.

        Raises:
            InputError: The source gives none.
        """
        return self._thread.submit(self._read).result()

    def close(self) -> None:
        """End the source and the thread."""
        self._thread.submit(self._let_go).result()
        self._thread.shutdown(wait=True, cancel_futures=True)

    def _begin(self, source: Callable[[], FrameSource]) -> None:
        self._source = source()

    def _read(self) -> Frame:
        self._before(self._source)
        return self._source.read()

    def _let_go(self) -> None:
        del self._source
