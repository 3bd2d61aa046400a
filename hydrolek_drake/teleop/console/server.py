"""The operator's console: one page, two pictures, one web socket; for this machine only unless told otherwise."""

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Callable
from typing import Any

import tornado.httpserver
import tornado.iostream
import tornado.netutil
import tornado.web
import tornado.websocket

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.access import new_token
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.console.browser_socket import Socket
from hydrolek_drake.teleop.console.desk import Desk
from hydrolek_drake.teleop.console.gate import Gate
from hydrolek_drake.teleop.console.pages import Icon, Nothing, Page, Picture, Script
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.teleop.trial import TrialLog

_LOG = logging.getLogger(__name__)

_LONGEST_MESSAGE = 4096  # bytes; the page's own are below 300
_LONGEST_HEADER = 16384  # bytes
_STATE_PERIOD = 0.1  # s between states
_LIVE_PERIOD = 0.4  # s between live pictures
_AGAIN = 1.0  # s before what failed is begun again


class Console(Desk):
    """Serves a session to browsers. The first one with the token is in control; others watch, and may stop the arms.

    Args:
        session: What the operator works at.
        port: TCP port, 0 for any free one.
        host: Address to listen at.
        allowed_hosts: Further names under which the console is reached.
        token: What control needs; a new one if not given.
        view_port: Of Drake's browser view, shown beside the pictures, if there is one.
        trials: Where timed trials and their ratings are written; a timer alone if not given.

    Attributes:
        token: What control needs.
        port: TCP port.

    Raises:
        InputError: The port cannot be listened at.
    """

    def __init__(
        self,
        session: OperatorSession,
        *,
        port: int,
        host: str = "127.0.0.1",
        allowed_hosts: tuple[str, ...] = (),
        token: str | None = None,
        view_port: int | None = None,
        trials: TrialLog | None = None,
    ) -> None:
        self.token = new_token() if token is None else token
        super().__init__(
            session,
            Gate(host, allowed_hosts, self.token),
            TrialLog(None) if trials is None else trials,
            view_port,
        )
        limits = teleop_entries("console")
        settings = {"console": self}
        application = tornado.web.Application(
            [
                (r"/", Page, settings),
                (r"/(colour|edges)\.jpg", Picture, settings),
                (r"/(charts|gamepad|manual|trial)\.js", Script, settings),
                (r"/icon\.svg", Icon, settings),
                (r"/socket", Socket, settings),
                (r".*", Nothing, settings),
            ],
            websocket_max_message_size=_LONGEST_MESSAGE,
            websocket_ping_interval=limits["ping"],
            websocket_ping_timeout=limits["ping"],
            log_function=lambda handler: None,
        )
        try:
            sockets = tornado.netutil.bind_sockets(port, host)
        except (OSError, OverflowError, UnicodeError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise InputError(
                f"teleop: cannot listen at {host}:{port}: {reason}; choose another --port"
            ) from None
        self.port: int = sockets[0].getsockname()[1]
        self._server = _Server(
            application,
            idle_connection_timeout=limits["header"],
            body_timeout=limits["header"],
            max_header_size=_LONGEST_HEADER,
            max_body_size=_LONGEST_MESSAGE,
        )
        self._server.most = int(limits["connections"])
        self._server.add_sockets(sockets)

    async def run(self) -> None:
        """Send states and refresh the live picture until cancelled."""
        await asyncio.gather(
            _kept_going("states", self._send_states, _STATE_PERIOD),
            _kept_going("live picture", self._refresh, _LIVE_PERIOD),
            _kept_going("control", self._watch_over_control, _STATE_PERIOD),
        )

    def close(self) -> None:
        """Stop the arms and then serving; open pages say that the console is gone."""
        with contextlib.suppress(
            Exception
        ):  # whatever ends it: valves before threads, which may take their time
            self.session.halt()
        self._server.stop()
        for browser in list(self.seats.browsers):
            browser.close()
        self.end_work()

    async def _send_states(self) -> None:
        if not self.seats.browsers:
            return
        state = await asyncio.get_running_loop().run_in_executor(self.workers, self.session.state)
        state |= {"view_port": self.view_port, "trial": self.trials.state()}
        holder = self.seats.holder()
        for browser in list(self.seats.browsers):
            browser.show(state, browser is holder, len(self.seats.browsers))

    async def _refresh(self) -> None:
        if self.seats.browsers:
            await asyncio.get_running_loop().run_in_executor(self.workers, self.session.refresh)

    async def _watch_over_control(self) -> None:
        self.seats.holder()


async def _kept_going(what: str, once: Callable[[], Awaitable[None]], period: float) -> None:
    """Repeat until cancelled; what fails is told in the log and begun again."""
    while True:
        try:
            await once()
        except Exception:
            _LOG.exception("teleop: %s failed; begun again", what)
            await asyncio.sleep(_AGAIN)
        await asyncio.sleep(period)


class _Server(tornado.httpserver.HTTPServer):
    """Refuses connections beyond a number, so that idle ones do not take all files of the process."""

    most = 0

    def handle_stream(self, stream: tornado.iostream.IOStream, address: tuple[Any, ...]) -> None:
        if len(self._connections) >= self.most:
            stream.close()
            return
        super().handle_stream(stream, address)
