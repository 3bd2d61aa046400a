"""Samples over TCP: a sender connects and writes the lines of a recording's CSV (docs/guides/watching.md).

One sender at a time. It listens at the loopback address unless told otherwise, and asks for a token then.
"""

import socket
import socketserver
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.teleop.access import same_token
from hydrolek_drake.watching.live.lines import LineReader
from hydrolek_drake.watching.live.samples import Samples
from hydrolek_drake.watching.live.settings import BAD_IN_A_ROW, LONGEST_LINE, WAITING
from hydrolek_drake.watching.live.sources import Link

_TOKEN = "TOKEN"
_TOKEN_S = 5.0
"""A sender shows its token within so long, or makes room for the next one."""

_KEPT_ALIVE = {"TCP_KEEPIDLE": 5, "TCP_KEEPINTVL": 2, "TCP_KEEPCNT": 3}
"""After so many seconds of silence it is asked whether it is there, so often, and then so many times."""

_TOLD_S = 0.5
"""A sender that is refused has so long to hear why."""


class TcpSource:
    """Listens for a sender; when one has gone, another may come.

    Attributes:
        port: where it listens.
    """

    def __init__(
        self,
        host: str,
        port: int,
        rig: Rig,
        token: str | None = None,
        accepts: Callable[[Samples], None] = lambda samples: None,
    ) -> None:
        """Listen.

        Args:
            host: address.
            port: 0 for any free one.
            rig: with the names of columns.
            token: that a sender must show first; None for none.
            accepts: raises `InputError` for samples whose signals will not do.

        Raises:
            InputError: it cannot listen there.
        """
        self._rig, self._token, self._accepts = rig, token, accepts
        self._lock = threading.Lock()
        self._samples: deque[tuple[Samples, float]] = deque()
        self._waiting = 0
        self._sender: socket.socket | None = None
        self._state, self._text = "waiting", "no sender yet"
        self._bad, self._dropped = 0, 0
        try:
            self._server = _Server((host, port), self)
        except (OSError, OverflowError, UnicodeError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise InputError(
                f"--live: cannot listen at {host}:{port}: {reason}; "
                "choose an address of this computer, or another port"
            ) from None
        self.port: int = self._server.server_address[1]
        self._host = host
        threading.Thread(target=self._server.serve_forever, args=(0.1,), name="live", daemon=True).start()

    def read(self) -> list[tuple[Samples, float | None]]:
        """What has come."""
        with self._lock:
            found: list[tuple[Samples, float | None]] = list(self._samples)
            self._samples.clear()
            self._waiting = 0
        return found

    def link(self) -> Link:
        """How it does."""
        with self._lock:
            name = f"tcp://{self._host}:{self.port}"
            return Link(name, self._state, self._text, self._bad, self._dropped, timely=True)

    def close(self) -> None:
        """End the connection and stop listening."""
        self._server.shutdown()
        self._server.server_close()
        with self._lock:
            sender = self._sender
        if sender is not None:
            try:
                sender.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass  # it has gone already

    def enter(self, connection: socket.socket) -> bool:
        """Whether a sender may begin: there is no other."""
        with self._lock:
            if self._sender is not None:
                return False
            self._sender = connection
            self._state, self._text = "open", "a sender is connected"
            return True

    def leave(self, reason: str) -> None:
        """The sender has gone."""
        with self._lock:
            self._sender = None
            self._state, self._text = "lost", reason

    def converse(self, connection: socket.socket) -> str:
        """Take lines until the sender goes; why it ended.

        Raises:
            InputError: what the sender is told before its connection is closed.
        """
        reader = LineReader(self._rig.columns, "stream")
        trusted, named, rest = self._token is None, False, b""
        connection.settimeout(None if trusted else _TOKEN_S)
        while received := connection.recv(1 << 16):
            *lines, rest = (rest + received).split(b"\n")
            if len(rest) > LONGEST_LINE:
                raise InputError(f"a line is longer than {LONGEST_LINE} bytes")
            text = [line.decode("ascii", errors="replace") for line in lines]
            if text and not trusted:
                word, _, shown = text.pop(0).strip().partition(" ")
                if word != _TOKEN or not same_token(shown, self._token or ""):
                    raise InputError(f"this stream needs {_TOKEN} and its token first")
                trusted = True
                connection.settimeout(None)
                connection.sendall(b"OK\n")
            before = reader.bad
            found = reader.read(text)
            if not named and (signals := reader.named()) is not None:
                self._accepts(signals)
                named = True
                connection.sendall(b"OK\n")
            # a sender that comes again goes on by its clock; what it leaves out is a gap
            found = [replace(samples, begins=False) for samples in found]
            self._keep(found, reader.bad - before)
            if reader.bad_in_a_row >= BAD_IN_A_ROW:
                raise InputError(
                    f"{BAD_IN_A_ROW} lines in a row are no samples, the last one {reader.last_bad}"
                )
        return "the sender has gone"

    def _keep(self, found: list[Samples], bad: int) -> None:
        now = time.monotonic()
        with self._lock:
            self._bad += bad
            for samples in found:
                self._samples.append((samples, now))
                self._waiting += samples.time.size
            while self._waiting > WAITING and len(self._samples) > 1:
                lost = self._samples.popleft()[0].time.size
                self._waiting -= lost
                self._dropped += lost


class _Server(socketserver.ThreadingTCPServer):
    """A thread for each connection."""

    daemon_threads = True
    block_on_close = False
    allow_reuse_address = True

    def __init__(self, address: tuple[str, int], source: TcpSource) -> None:
        self.source = source
        if ":" in address[0]:
            self.address_family = socket.AF_INET6
        super().__init__(address, _Connection)

    def handle_error(self, request: object, client_address: object) -> None:
        """A connection that fails ends; the next sender may come."""


class _Connection(socketserver.BaseRequestHandler):
    """One sender."""

    server: _Server

    def handle(self) -> None:
        source, connection = self.server.source, self.request
        _kept_alive(connection)
        if not source.enter(connection):
            _tell(connection, "BUSY another sender is connected")
            return
        reason = "the sender failed"
        try:
            reason = source.converse(connection)
        except InputError as error:
            reason = str(error)
            _tell(connection, f"ERROR {reason}")
        except TimeoutError:
            reason = f"no token within {_TOKEN_S:g} s"
            _tell(connection, f"ERROR {reason}")
        except OSError:
            reason = "the connection was lost"
        finally:
            source.leave(reason)


def _kept_alive(connection: socket.socket) -> None:
    """Have the system ask a silent sender whether it is still there, so that one whose cable was pulled leaves."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _KEPT_ALIVE.items():
        if hasattr(socket, name):  # not on every system
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def _tell(connection: socket.socket, text: str) -> None:
    """Say why the connection ends, if the sender still hears it.

    What it has sent meanwhile is taken for a while: closed with unread data, a connection loses what was said last.
    """
    try:
        connection.settimeout(_TOLD_S)
        connection.sendall(f"{' '.join(text.split())}\n".encode("ascii", errors="replace"))
        connection.shutdown(socket.SHUT_WR)
        until = time.monotonic() + _TOLD_S
        while time.monotonic() < until and connection.recv(1 << 16):
            pass
    except OSError:
        pass
