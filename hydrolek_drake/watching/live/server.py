"""The page of a live watch: one page, one web socket that only tells, for this machine alone.

Nobody can do anything over it: what a browser sends is not read. Names under which it is served are checked as the
console's are, so that no page of another site can listen.
"""

import asyncio
import contextlib
import json
import threading
from collections.abc import Callable
from typing import Any

import tornado.httpserver
import tornado.netutil
import tornado.web
import tornado.websocket

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.console.gate import Gate
from hydrolek_drake.teleop.console.guarded import Guarded

_HOST = "127.0.0.1"
_MOST = 16
"""Browsers at a time."""

_LONGEST = 1024
"""Bytes of a message from a browser, which says nothing anyway."""


class LivePage:
    """Serves the page from a thread of its own.

    Attributes:
        port: where.
        address: of the page.
    """

    def __init__(self, port: int, first: Callable[[], dict[str, Any]]) -> None:
        """Listen.

        Args:
            port: 0 for any free one.
            first: what a browser is told when it comes: description and history.

        Raises:
            InputError: it cannot listen there.
        """
        self.gate = Gate(_HOST, (), "")
        self.first = first
        self.browsers: set[_Socket] = set()
        try:
            sockets = tornado.netutil.bind_sockets(port, _HOST)
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise InputError(
                f"--port {port}: cannot listen at {_HOST}:{port}: {reason}; choose another"
            ) from None
        self.port: int = sockets[0].getsockname()[1]
        self.address = f"http://{_HOST}:{self.port}/"
        self._loop = asyncio.new_event_loop()
        self._sockets = sockets
        ready = threading.Event()
        self._thread = threading.Thread(target=self._serve, args=(ready,), name="page", daemon=True)
        self._thread.start()
        ready.wait()

    def tell(self, what: dict[str, Any]) -> None:
        """Send to all browsers; from any thread."""
        if self.browsers:
            text = json.dumps(what, allow_nan=False)
            with contextlib.suppress(RuntimeError):  # it is closed
                self._loop.call_soon_threadsafe(self._send, text)

    def close(self) -> None:
        """Stop serving."""
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._end)
        self._thread.join(5.0)

    def _serve(self, ready: threading.Event) -> None:
        asyncio.set_event_loop(self._loop)
        settings = {"page": self}
        application = tornado.web.Application(
            [
                (r"/", _Page, settings),
                (r"/(live)\.js", _Script, settings),
                (r"/socket", _Socket, settings),
                (r".*", _Nothing, settings),
            ],
            websocket_max_message_size=_LONGEST,
            websocket_ping_interval=5,
            log_function=lambda handler: None,
        )

        async def begin() -> None:
            self._server = tornado.httpserver.HTTPServer(application, max_body_size=_LONGEST)
            self._server.add_sockets(self._sockets)
            ready.set()

        self._loop.run_until_complete(begin())
        self._loop.run_forever()
        self._loop.close()

    def _send(self, text: str) -> None:
        for browser in list(self.browsers):
            browser.tell(text)

    def _end(self) -> None:
        self._server.stop()
        for browser in list(self.browsers):
            browser.close()
        self._loop.call_later(0.1, self._loop.stop)


class _Handler(Guarded):
    """Answers only under names of this machine."""

    foreign = "the page is not served under this name"

    def initialize(self, page: LivePage) -> None:
        self.gate = page.gate


class _Nothing(_Handler):
    def get(self) -> None:
        self.refuse(404, "there is no such page")


class _Page(_Handler):
    def get(self) -> None:
        host = self.request.headers["Host"]  # one that was let in
        self.set_header(
            "Content-Security-Policy",
            f"default-src 'self' 'unsafe-inline'; connect-src 'self' ws://{host}; img-src 'self' data:; "
            "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        )
        self.give_file(__package__, "page.html", "text/html; charset=utf-8")


class _Script(_Handler):
    def get(self, name: str) -> None:
        self.give_file(__package__, f"{name}.js", "text/javascript; charset=utf-8")


class _Socket(tornado.websocket.WebSocketHandler):
    """One browser; one that is slow is told less often."""

    def initialize(self, page: LivePage) -> None:
        self.page = page
        self._sent: asyncio.Future[None] | None = None
        self._missed = False

    def prepare(self) -> None:
        headers, gate = self.request.headers, self.page.gate
        reason = gate.refused_host(headers.get("Host", ""))
        if not reason and "Origin" in headers:
            reason = gate.refused_origin(headers["Origin"], headers["Host"])
        if reason or len(self.page.browsers) >= _MOST:
            self.set_status(403)
            self.finish("refused\n")

    def check_origin(self, origin: str) -> bool:
        return True  # `prepare` has refused all others

    def open(self, *_args: str) -> None:
        self.page.browsers.add(self)
        self.tell(json.dumps(self.page.first(), allow_nan=False))

    def on_close(self) -> None:
        self.page.browsers.discard(self)

    def on_message(self, message: str | bytes) -> None:
        """Nothing is asked of it."""

    def tell(self, text: str) -> None:
        if self._sent is not None and not self._sent.done():
            self._missed = True
            return
        if self._missed:  # all that it missed at once
            self._missed, text = False, json.dumps(self.page.first(), allow_nan=False)
        try:
            self._sent = self.write_message(text)
        except tornado.websocket.WebSocketClosedError:
            self.on_close()
            return
        self._sent.add_done_callback(lambda done: done.cancelled() or done.exception())
