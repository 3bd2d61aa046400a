"""A frame source in a thread of its own, as a renderer must live and end in one thread."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures import TimeoutError as TookTooLong

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
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
        self._mute: Future[Frame] | None = None
        try:
            self._thread.submit(self._begin, source).result()
        except BaseException:
            self._thread.shutdown(wait=False)
            raise

    def read(self) -> Frame:
        """The next frame.

        Raises:
            InputError: The source gives none, or has not answered for too long.
        """
        patience = teleop_entries("camera")["mute"]
        if not self._is_mute():
            reading = self._thread.submit(self._read)
            try:
                return reading.result(timeout=patience)
            except TookTooLong:
                self._mute = reading
            except InputError:
                raise
            except Exception as error:
                raise InputError(
                    f"the camera failed ({type(error).__name__}: {error}); check its cable and power"
                ) from error
        raise InputError(f"the camera has not answered for {patience:g} s; check its cable and power")

    def close(self) -> None:
        """End the source and the thread; one that does not answer is left to itself."""
        mute = self._is_mute()
        if not mute:
            self._thread.submit(self._let_go).result()
        self._thread.shutdown(wait=not mute, cancel_futures=True)

    def _is_mute(self) -> bool:
        return self._mute is not None and not self._mute.done()

    def _begin(self, source: Callable[[], FrameSource]) -> None:
        self._source = source()

    def _read(self) -> Frame:
        self._before(self._source)
        return self._source.read()

    def _let_go(self) -> None:
        self._source.close()
        del self._source
