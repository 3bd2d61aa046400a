"""The controllers' end of the link: one TCP port, one client in control, STOP for everybody."""

import errno
import json
import logging
import socket
import socketserver
import threading
import time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.access import same_token
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.link.authority import Authority, BusyError, Client, LinkOrder
from hydrolek_drake.teleop.link.messages import BUSY, ERROR, VERSION, Request, Word, decode, encode
from hydrolek_drake.teleop.link.signals import Signals

Array = NDArray[np.float64]

_LOG = logging.getLogger(__name__)
_POLL_S = 0.1  # how soon closing is heard
_REST_S = 0.1  # before listening begins again after a failure


def silence(realtime_rate: float) -> float:
    """How long either end waits for the other [s]: `link.silence` of the machine's time, never less by the clock.

    Args:
        realtime_rate: Simulated seconds a second; 1 for a real machine.
    """
    return float(teleop_entries("link")["silence"] / min(1.0, realtime_rate))


class SetpointServer:
    """The controllers' end: what the client in control wants is `order`; who may be that is `Authority`'s to say.

    Nothing that a peer does ends the thread that listens; should it fail all the same, it is started again and the log
    says so. A connection that sends no whole message for `link.mute` seconds of teleop.yaml is ended.

    Args:
        posture: Set point until the first message, in rad, shape (14,).
        port: TCP port, 0 for any free one.
        host: Address to listen at; the loopback unless told otherwise.
        realtime_rate: Simulated seconds a second, of a simulated machine.
        token: What a client must send before anything but STOP is heeded; None for nothing.

    Raises:
        InputError: The port cannot be listened at.
    """

    def __init__(
        self,
        posture: ArrayLike,
        *,
        port: int | None = None,
        host: str = "127.0.0.1",
        realtime_rate: float = 1.0,
        token: str | None = None,
    ) -> None:
        values = teleop_entries("link")
        share = silence(realtime_rate) / values["silence"]
        self.mute: float = share * values["mute"]
        self.longest: int = int(values["longest_message"])
        self._most = int(values["connections"])
        self._authority = Authority(posture, silence=silence(realtime_rate), mute=self.mute)
        self._lock = threading.Lock()
        self._measured = np.array(posture, dtype=float)
        self._signals: Signals | None = None
        self._token = token
        self.message_came = threading.Event()
        self._connections: set[socket.socket] = set()
        self._closing = False
        wanted = int(values["port"]) if port is None else port
        try:
            self._listener = _Listener((host, wanted), self)
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise InputError(
                f"link: cannot listen at {host}:{wanted}: {reason}; choose another port"
            ) from None
        self.port: int = self._listener.server_address[1]
        threading.Thread(target=self._listen, name="link", daemon=True).start()

    def command(self) -> tuple[Array, bool, str]:
        """Set point in rad, whether the valves may be open, and if not, why."""
        order = self.order()
        return order.desired, order.valves_open, order.reason

    def order(self) -> LinkOrder:
        """What the client in control wants now; after silence, closed valves."""
        return self._authority.order()

    def report(self, measured: ArrayLike, signals: Signals | None = None) -> None:
        """Tell clients with the next answers where the joints are, in rad, shape (14,), and other signals."""
        with self._lock:
            self._measured, self._signals = np.array(measured, dtype=float), signals

    def close(self, reason: str = "the link was closed") -> None:
        """Close the valves, all connections and the port."""
        self._closing = True
        self._authority.close(reason)
        self._listener.shutdown()
        self._listener.server_close()
        with self._lock:
            connections = list(self._connections)
        for each in connections:
            try:
                each.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass  # it has gone already

    def enter(self, connection: socket.socket) -> Client | None:
        """A new connection; None if there are too many."""
        with self._lock:
            if len(self._connections) >= self._most or self._closing:
                return None
            self._connections.add(connection)
        return Client(trusted=self._token is None)

    def leave(self, client: Client, connection: socket.socket, reason: str) -> None:
        """A connection has ended."""
        with self._lock:
            self._connections.discard(connection)
        self._authority.leave(client, reason)

    def answer(self, client: Client, line: bytes) -> bytes:
        """Act on a line and say what is answered.

        Raises:
            InputError: A bad message, or a client that was dropped: the valves are closed and the connection is to end.
        """
        if client.dropped:
            raise InputError(client.dropped)
        try:
            if len(line) > self.longest:
                raise InputError(f"a message is longer than {self.longest} bytes")
            request = decode(line)
            if request.word is Word.TOKEN:
                self._trust(client, request.text)
            elif not client.trusted and request.word not in (Word.STOP, Word.VERSION):
                raise InputError(f"this link needs {Word.TOKEN.value} and its token first")
        except InputError as error:
            self._authority.bad(client, str(error))
            raise
        try:
            return self._carry_out(client, request)
        except BusyError as busy:
            return f"{BUSY} {busy}\n".encode("ascii", errors="replace")

    def _carry_out(self, client: Client, request: Request) -> bytes:
        word = request.word
        if word is Word.TOKEN:
            return b"OK\n"
        if word is Word.VERSION:
            return f"{Word.VERSION.value} {VERSION}\n".encode("ascii")
        if word is Word.STATUS:
            order = self.order()
            flags = f"{order.valves_open:d},{self._authority.in_control(client):d}"
            return f"{Word.STATUS.value},{flags},{order.reason}\n".encode("ascii", errors="replace")
        if word is Word.SIGNALS:
            with self._lock:
                return b"{}\n" if self._signals is None else self._signals.to_line()
        if word is Word.STOP:
            self._authority.stop(client)
        elif word is Word.CONTROL:
            self._authority.take(client)
        else:
            self._authority.lead(client, angles=request.angles, deflection=request.deflection)
        with self._lock:
            answer = encode(self._measured)
        if self._authority.in_control(client):
            self.message_came.set()
        return answer

    def _trust(self, client: Client, token: str) -> None:
        if self._token is not None and not same_token(token, self._token):
            raise InputError("this is not the token of this link")
        client.trusted = True

    def _listen(self) -> None:
        while True:  # at least once, since `close` waits for the end of `serve_forever`
            try:
                self._listener.serve_forever(_POLL_S)
            except Exception as error:
                if not self._closing:
                    _LOG.error(
                        "link: listening failed (%s: %s); it begins again", type(error).__name__, error
                    )
                    time.sleep(_REST_S)
            if self._closing:
                return


class _Listener(socketserver.ThreadingTCPServer):
    """A thread for each connection; what goes wrong in one is logged and concerns no other."""

    daemon_threads = True
    block_on_close = False
    allow_reuse_address = True
    request_queue_size = 64  # connections that wait while many come at once

    def __init__(self, address: tuple[str, int], link: SetpointServer) -> None:
        self.link = link
        if ":" in address[0]:
            self.address_family = socket.AF_INET6
        super().__init__(address, _Connection)

    def get_request(self) -> tuple[Any, Any]:
        try:
            return super().get_request()
        except OSError as error:
            if error.errno in (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM):
                time.sleep(_REST_S)  # the connection waits; asking again at once would take a whole core
            raise

    def handle_error(self, request: Any, client_address: Any) -> None:
        _LOG.exception("link: the connection of %s failed; the valves are closed", client_address)


class _Connection(socketserver.BaseRequestHandler):
    """Lines of one client."""

    server: _Listener

    def handle(self) -> None:
        link, connection = self.server.link, self.request
        client = link.enter(connection)
        if client is None:
            _tell(connection, BUSY, "too many connections")
            return
        reason = "the client has gone"
        try:
            self._converse(link, client)
        except InputError as error:
            reason = str(error)
            _tell(connection, ERROR, reason)
        except TimeoutError:
            reason = f"no whole message for {link.mute:g} s"
            _tell(connection, ERROR, reason)
        except OSError:
            pass  # the client has gone
        finally:
            link.leave(client, connection, reason)

    def _converse(self, link: SetpointServer, client: Client) -> None:
        pending, deadline = b"", time.monotonic() + link.mute
        while True:
            left = deadline - time.monotonic()
            if left <= 0.0:
                raise TimeoutError
            self.request.settimeout(left)
            received = self.request.recv(4096)
            if not received:
                return
            pending += received
            *lines, pending = pending.split(b"\n")
            for line in lines:
                answer = link.answer(client, line)
                if line.endswith(b"\r"):
                    answer = answer.replace(b"\n", b"\r\n")  # ends as the request did: LabVIEW reads to CR LF
                deadline = time.monotonic() + link.mute
                self.request.settimeout(link.mute)
                self.request.sendall(answer)
            if len(pending) > link.longest:
                link.answer(client, pending)  # refused, with its reason


def _tell(connection: socket.socket, word: str, reason: str) -> None:
    """Say why the connection ends, if the client still hears it."""
    try:
        connection.settimeout(_POLL_S)
        connection.sendall(f"{word} {json.dumps(reason)[1:-1]}\n".encode("ascii"))
    except OSError:
        pass
