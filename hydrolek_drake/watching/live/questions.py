"""Windows asked which effect changed, in a process beside, so that the observer is never late for it.

The question, the reference and the rule are those of `hydrolek watch`. A window that comes while another one is being
asked is passed over: the next one is the freshest.
"""

import multiprocessing
import signal
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path

from hydrolek_drake.diagnosis.structures.splitting import reasons_against
from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.asking import asked
from hydrolek_drake.watching.live.windows import Window
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.stamps import Stamp
from hydrolek_drake.watching.store import Seen, Store, digest_of
from hydrolek_drake.watching.watch import key_of_all, training_of

_END_S = 5.0
"""A question that is being asked when the watch ends is waited for so long."""


class Questions:
    """The process beside.

    Attributes:
        passed_over: windows that came while it was busy.
        failed: why it no longer runs; empty while it does.
    """

    def __init__(
        self,
        rig: Rig,
        reference: Sequence[Path],
        folder: Path,
        drift: Mapping[str, float],
        joints: Sequence[str],
    ) -> None:
        """Start it.

        Args:
            rig: the machine's nominal model.
            reference: recordings of the healthy machine, fitted and kept in the folder.
            folder: of the watch.
            drift: as of `watch`.
            joints: in the order of a window's rows.
        """
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(
            target=_serve,
            args=(theirs, rig, list(reference), folder, dict(drift), tuple(joints)),
            name="questions",
            daemon=True,
        )
        self._process.start()
        theirs.close()
        self._busy = False
        self.passed_over, self.failed = 0, ""

    def ask(self, window: Window) -> bool:
        """Hand in a window; false if it is passed over."""
        if self._busy or self.failed:
            self.passed_over += 1
            return False
        try:
            self._pipe.send(window)
        except OSError as error:
            self.failed = f"the process beside has ended: {error}"
            return False
        self._busy = True
        return True

    def answers(self) -> list[Seen]:
        """What was answered since the last call."""
        found = []
        try:
            while self._pipe.poll():
                found.append(self._pipe.recv())
                self._busy = False
        except (EOFError, OSError):
            self.failed = self.failed or "the process beside has ended; windows are no longer asked"
            self._busy = False
        return found

    @property
    def busy(self) -> bool:
        """Whether a window is being asked."""
        return self._busy

    def close(self) -> list[Seen]:
        """End it; what it still answers."""
        found = self.answers()
        if self._busy and self._pipe.poll(_END_S):
            found += self.answers()
        self._process.terminate()
        self._process.join(_END_S)
        self._pipe.close()
        return found


def _serve(
    pipe: Connection,
    rig: Rig,
    reference: list[Path],
    folder: Path,
    drift: dict[str, float],
    joints: tuple[str, ...],
) -> None:
    """Answer windows until the pipe is closed."""
    from threadpoolctl import threadpool_limits

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the watch's to heed
    with threadpool_limits(limits=1, user_api="blas"), ThreadPoolExecutor(1) as pool:
        training = training_of(rig, reference)
        store = Store(folder, key_of_all(rig, training, drift))
        kept = store.reference()
        session = Session(
            rig, [e for each in training for e in each.experiments], pool, 1, drift, kept[0] if kept else None
        )
        while True:
            try:
                window = pipe.recv()
            except (EOFError, OSError):
                return
            seen = answer(session, window, folder, joints)
            try:
                store.keep(seen)
            except (InputError, OSError) as error:
                seen = replace(seen, problem=f"{seen.problem} (not kept: {error})".strip())
            pipe.send(seen)


def answer(session: Session, window: Window, folder: Path, joints: Sequence[str]) -> Seen:
    """What a window says; it is written into the folder first.

    Args:
        session: rig and reference.
        window: to ask.
        folder: of the watch.
        joints: in the order of the window's rows.
    """
    stamp, path, digest = Stamp(window.ended, "clock"), folder, ""
    try:
        path = window.write(folder, session.rig, joints)
        digest = digest_of(path)
        recording = read_recording(path)
        experiments = window.experiments(session.rig, recording, joints)
        reasons = reasons_against(recording, experiments)
        if reasons:
            raise InputError(f"{path}: {reasons[0]}")
        return Seen(str(path), digest, stamp, asked(session, experiments))
    except InputError as error:  # one window stops no watch
        return Seen(str(path), digest, stamp, None, str(error))
    except Exception as error:
        return Seen(str(path), digest, stamp, None, f"{type(error).__name__}: {error}")
