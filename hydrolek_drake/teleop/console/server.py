"""The operator's console: one page, two pictures, one web socket; for this machine only unless told otherwise."""

import asyncio
import contextlib
import json
import logging
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from typing import Any

import tornado.httpserver
import tornado.iostream
import tornado.netutil
import tornado.web
import tornado.websocket

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.access import new_token
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.console import messages
from hydrolek_drake.teleop.console.gate import Gate
from hydrolek_drake.teleop.console.seats import Seats
from hydrolek_drake.teleop.sequencer import Order
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.teleop.trial import TrialLog

_LOG = logging.getLogger(__name__)

_LONGEST_MESSAGE = 4096  # bytes; the page's own are below 300
_LONGEST_HEADER = 16384  # bytes
_WAITING = 32  # messages of one browser that wait for their turn
_STATE_PERIOD = 0.1  # s between states
_LIVE_PERIOD = 0.4  # s between live pictures
_AGAIN = 1.0  # s before what failed is begun again


class Console:
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
        self.session, self.view_port = session, view_port
        self.token = new_token() if token is None else token
        self.gate = Gate(host, allowed_hosts, self.token)
        self.trials = TrialLog(None) if trials is None else trials
        limits = teleop_entries("console")
        self.most = int(limits["browsers"])
        self.seats: Seats[_Socket] = Seats(limits["mute"], self._control_lost)
        self.workers = ThreadPoolExecutor(2, thread_name_prefix="console")
        self._stopper = ThreadPoolExecutor(
            1, thread_name_prefix="stop"
        )  # never waits for a camera or a planner
        settings = {"console": self}
        application = tornado.web.Application(
            [
                (r"/", _Page, settings),
                (r"/(colour|edges)\.jpg", _Picture, settings),
                (r"/(charts|manual|trial)\.js", _Script, settings),
                (r"/icon\.svg", _Icon, settings),
                (r"/socket", _Socket, settings),
                (r".*", _Nothing, settings),
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
        """Stop serving; open pages say that the console is gone."""
        self._server.stop()
        for browser in list(self.seats.browsers):
            browser.close()
        self.workers.shutdown(wait=True, cancel_futures=True)
        self._stopper.shutdown(wait=True)

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

    def _control_lost(self) -> None:
        """The arms must not go on without somebody who sees them; does not wait for the machine."""
        with contextlib.suppress(RuntimeError):  # the console is closed, and the machine with it
            self._stopper.submit(self.session.lose_operator)

    async def stop(self) -> None:
        """Stop the arms at once, whatever else is going on, then tell the session so."""
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._stopper, self.session.halt)
        await loop.run_in_executor(self.workers, self.session.order, Order.STOP)

    def act(self, message: messages.AnyMessage) -> None:
        """Do what the browser in control asks for.

        Raises:
            InputError: It is not possible now.
        """
        session = self.session
        match message:
            case messages.Click(u=u, v=v):
                session.click(u, v)
            case messages.Sliders():
                session.set_sliders(**message.given())
            case messages.Fill(name=name):
                session.set_fill(name)
            case messages.TaskChoice(name=name):
                session.set_task(name)
            case messages.Joystick(deflection=deflection):
                session.move_by_hand(deflection=deflection)
            case messages.SlidersTo(angles_deg=angles):
                session.move_by_hand(towards_deg=angles)
            case messages.Timer(action=action):
                self.trials.timer(action)
            case messages.Ratings():
                self.trials.save(message.given())
            case messages.Plain(do="resume"):
                session.order(Order.RESUME)
            case messages.Plain(do="abort"):
                session.order(Order.ABORT)
            case messages.Plain(do=what):
                getattr(session, what)()


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


class _Handler(tornado.web.RequestHandler):
    def initialize(self, console: Console) -> None:
        self.console = console

    def set_default_headers(self) -> None:
        self.set_header("Cache-Control", "no-store")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Referrer-Policy", "no-referrer")
        self.clear_header("Server")

    def prepare(self) -> None:
        reason = self.console.gate.refused_host(self.request.headers.get("Host", ""))
        if reason:
            self.set_status(403)
            self.finish(reason + "\n")

    def write_error(self, status_code: int, **kwargs: Any) -> None:
        self.finish(f"{status_code} {self._reason}\n")


class _Nothing(_Handler):
    def get(self) -> None:
        self.set_status(404)
        self.finish("the console has no such page\n")


class _Page(_Handler):
    def get(self) -> None:
        self.set_header("Content-Type", "text/html; charset=utf-8")
        host = self.request.headers["Host"]  # one that was let in
        policy = [
            "default-src 'self' 'unsafe-inline'",
            f"connect-src 'self' ws://{host} wss://{host}",
            "img-src 'self' blob:",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'none'",  # nobody lays the STOP of another page over it
        ]
        if self.console.view_port is not None:
            policy.append(f"frame-src http://{self.request.host_name}:{self.console.view_port}")
        self.set_header("Content-Security-Policy", "; ".join(policy))
        self.finish(files(__package__).joinpath("page.html").read_text(encoding="utf-8"))


class _Script(_Handler):
    def get(self, name: str) -> None:
        self.set_header("Content-Type", "text/javascript; charset=utf-8")
        self.finish(files(__package__).joinpath(f"{name}.js").read_text(encoding="utf-8"))


class _Icon(_Handler):
    def get(self) -> None:
        self.set_header("Content-Type", "image/svg+xml")
        self.finish(files(__package__).joinpath("icon.svg").read_text(encoding="utf-8"))


class _Picture(_Handler):
    def get(self, name: str) -> None:
        gate = self.console.gate
        if not gate.watching_is_free:
            scheme, _, token = self.request.headers.get("Authorization", "").partition(" ")
            if scheme != "Bearer" or not gate.trusts(token):
                self.set_status(401)
                self.finish("watching needs the token of the address that the console has printed\n")
                return
        picture = self.console.session.picture(name)
        if not picture:
            self.set_status(204)  # there is none yet
            return
        self.set_header("Content-Type", "image/jpeg")
        self.finish(picture)


class _Socket(tornado.websocket.WebSocketHandler):
    """One browser. STOP is heeded at once, whoever sends it; all else in its order, from the one in control."""

    def initialize(self, console: Console) -> None:
        self.console, self.trusted = console, False
        self._waiting: asyncio.Queue[messages.AnyMessage] = asyncio.Queue(_WAITING)
        self._worker: asyncio.Task[None] | None = None
        self._stopping: asyncio.Task[None] | None = None
        self._sent: asyncio.Future[None] | None = None

    def prepare(self) -> None:
        headers, gate = self.request.headers, self.console.gate
        reason = gate.refused_host(headers.get("Host", ""))
        if not reason and "Origin" in headers:
            reason = gate.refused_origin(headers["Origin"], headers["Host"])
        if not reason and len(self.console.seats.browsers) >= self.console.most:
            reason = "too many browsers watch; close one"
        if reason:
            self.set_status(403)
            self.finish(reason + "\n")

    def check_origin(self, origin: str) -> bool:
        return True  # `prepare` has refused all others

    def open(self, *_args: str) -> None:
        self.console.seats.enter(self)
        self._worker = asyncio.ensure_future(self._carry_out())

    def on_close(self) -> None:
        self.console.seats.leave(self)
        if self._worker is not None:
            self._worker.cancel()

    def on_message(self, message: str | bytes) -> None:
        try:
            asked = messages.parse(message)
            self.console.seats.heard(self)
            match asked:
                case messages.Stop():
                    self._stopping = asyncio.ensure_future(self._stop())
                case messages.Here():
                    pass
                case messages.Token(token=token):
                    self._show(token)
                case _:
                    self._refuse_unless_in_control()
                    self._waiting.put_nowait(asked)
        except InputError as error:
            self.tell({"error": str(error)})
        except asyncio.QueueFull:
            self.tell({"error": "too many messages at once; wait for the answers"})

    def show(self, state: dict[str, Any], in_control: bool, watching: int) -> None:
        """Send a state, unless this browser has not taken the last one yet."""
        if not self.trusted and not self.console.gate.watching_is_free:
            state, watching = {}, 0
        self.console.seats.asked(self)
        if self._sent is None or self._sent.done():
            self.tell(
                {
                    "state": state or None,
                    "in_control": in_control,
                    "watching": watching,
                    "trusted": self.trusted,
                }
            )

    def tell(self, what: dict[str, Any]) -> None:
        try:
            sent = self.write_message(json.dumps(what, allow_nan=False))
        except tornado.websocket.WebSocketClosedError:
            self.on_close()
            return
        self._sent = sent
        sent.add_done_callback(lambda done: done.cancelled() or done.exception())  # lost with the connection

    def _show(self, token: str) -> None:
        if not self.console.gate.trusts(token):
            raise InputError("this is not the console's token; open the address that it has printed")
        self.trusted = True
        self.console.seats.holder()
        self.tell({"error": ""})

    async def _stop(self) -> None:
        try:
            await self.console.stop()
            self.tell({"error": ""})
        except InputError as error:
            self.tell({"error": str(error)})
        except Exception as error:
            _LOG.exception("teleop: STOP failed")
            self.tell({"error": f"STOP failed: {error}"})

    async def _carry_out(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            asked = await self._waiting.get()
            try:
                self._refuse_unless_in_control()
                await loop.run_in_executor(self.console.workers, self.console.act, asked)
                self.tell({"error": ""})
            except InputError as error:
                self.tell({"error": str(error)})
            except Exception as error:
                _LOG.exception("teleop: %s failed", type(asked).__name__)
                self.tell({"error": f"it failed: {type(error).__name__}: {error}"})

    def _refuse_unless_in_control(self) -> None:
        if self.console.seats.holder() is self:
            return
        if not self.trusted:
            raise InputError("control needs the token; open the address that the console has printed")
        raise InputError("another browser is in control; this one watches, and may stop the arms")
