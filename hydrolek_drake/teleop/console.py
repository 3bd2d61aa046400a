"""The operator's console: one page, two pictures, one web socket; for this machine only unless told otherwise."""

import asyncio
import json
import math
import re
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from typing import Any

import tornado.httpserver
import tornado.netutil
import tornado.web
import tornado.websocket

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.sequencer import Order
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.teleop.trial import TrialLog

_LONGEST_MESSAGE = 4096  # bytes; the page's own are below 200
_STATE_PERIOD = 0.1  # s between states
_LIVE_PERIOD = 0.4  # s between live pictures
_JOINTS = 14
_HOST = re.compile(r"[\w.:\[\]-]+")  # what may stand in a header
_ORDERS = {"stop": Order.STOP, "resume": Order.RESUME, "abort": Order.ABORT}


class Console:
    """Serves a session to browsers. The first one is in control; others watch, and may stop the arms.

    Args:
        session: What the operator works at.
        port: TCP port, 0 for any free one.
        host: Address to listen at.
        view_port: Of Drake's browser view, shown beside the pictures, if there is one.
        trials: Where timed trials and their ratings are written; a timer alone if not given.
    """

    def __init__(
        self,
        session: OperatorSession,
        *,
        port: int,
        host: str = "127.0.0.1",
        view_port: int | None = None,
        trials: TrialLog | None = None,
    ) -> None:
        self.session, self.view_port = session, view_port
        self.trials = TrialLog(None) if trials is None else trials
        self.clients: list[_Socket] = []
        self.workers = ThreadPoolExecutor(2, thread_name_prefix="console")
        settings = {"console": self}
        application = tornado.web.Application(
            [
                (r"/", _Page, settings),
                (r"/(colour|edges)\.jpg", _Picture, settings),
                (r"/(charts|manual|trial)\.js", _Script, settings),
                (r"/icon\.svg", _Icon, settings),
                (r"/socket", _Socket, settings),
            ],
            websocket_max_message_size=_LONGEST_MESSAGE,
        )
        try:
            sockets = tornado.netutil.bind_sockets(port, host)
        except OSError as error:
            raise InputError(
                f"teleop: cannot listen at {host}:{port}: {error.strerror}; choose another --port"
            ) from None
        self.port: int = sockets[0].getsockname()[1]
        self._server = tornado.httpserver.HTTPServer(application)
        self._server.add_sockets(sockets)

    async def run(self) -> None:
        """Send states and refresh the live picture until cancelled."""
        await asyncio.gather(self._states(), self._live())

    def close(self) -> None:
        """Stop serving; open pages say that the console is gone."""
        self._server.stop()
        for client in list(self.clients):
            client.close()
        self.workers.shutdown(wait=True, cancel_futures=True)

    async def _states(self) -> None:
        while True:
            if self.clients:
                state = await asyncio.get_running_loop().run_in_executor(self.workers, self.session.state)
                state |= {"view_port": self.view_port, "trial": self.trials.state()}
                for place, client in enumerate(list(self.clients)):
                    client.tell({"state": state, "in_control": place == 0, "watching": len(self.clients)})
            await asyncio.sleep(_STATE_PERIOD)

    async def _live(self) -> None:
        while True:
            if self.clients:
                await asyncio.get_running_loop().run_in_executor(self.workers, self.session.refresh)
            await asyncio.sleep(_LIVE_PERIOD)

    def act(self, message: dict[str, Any]) -> None:
        """Do what a browser asks for.

        Raises:
            InputError: It asks for something that is unknown, malformed, or not possible now.
        """
        session, what = self.session, message.get("do")
        if what == "click":
            session.click(_number(message, "u"), _number(message, "v"))
        elif what == "sliders":
            session.set_sliders(**{name: _number(message, name) for name in message if name != "do"})
        elif what == "fill":
            session.set_fill(str(message.get("name")))
        elif what == "task":
            session.set_task(str(message.get("name")))
        elif what in ("snapshot", "back", "confirm", "release"):
            getattr(session, str(what))()
        elif what == "joystick":
            session.move_by_hand(deflection=_numbers(message, "deflection"))
        elif what == "sliders_to":
            session.move_by_hand(towards_deg=_numbers(message, "angles_deg"))
        elif what == "let_go":
            session.let_go()
        elif what == "timer":
            self.trials.timer(str(message.get("action")))
        elif what == "ratings":
            self.trials.save({name: value for name, value in message.items() if name != "do"})
        elif what in _ORDERS:
            session.order(_ORDERS[what])
        else:
            raise InputError(f"the console does not know '{str(what)[:40]}'")


def _numbers(message: dict[str, Any], name: str) -> list[float]:
    values = message.get(name)
    if not isinstance(values, list) or len(values) != _JOINTS:
        raise InputError(f"'{name}' must be {_JOINTS} numbers, right_j1 to left_j7")
    return [_finite(value, name) for value in values]


def _number(message: dict[str, Any], name: str) -> float:
    return _finite(message.get(name), name)


def _finite(value: Any, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise InputError(f"'{name[:40]}' must be a finite number")
    return float(value)


class _Handler(tornado.web.RequestHandler):
    def initialize(self, console: Console) -> None:
        self.console = console
        self.set_header("Cache-Control", "no-store")


class _Page(_Handler):
    def get(self) -> None:
        self.set_header("Content-Type", "text/html; charset=utf-8")
        policy = "default-src 'self' 'unsafe-inline'; connect-src 'self' ws:"
        host = self.request.host_name
        if self.console.view_port is not None and _HOST.fullmatch(host):
            policy += f"; frame-src http://{host}:{self.console.view_port}"
        self.set_header("Content-Security-Policy", policy)
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
        picture = self.console.session.picture(name)
        if not picture:
            self.set_status(204)  # there is none yet
            return
        self.set_header("Content-Type", "image/jpeg")
        self.finish(picture)


class _Socket(tornado.websocket.WebSocketHandler):
    def initialize(self, console: Console) -> None:
        self.console = console

    def open(self, *_args: str) -> None:
        self.console.clients.append(self)

    def on_close(self) -> None:
        if self.console.clients[:1] == [self]:
            self.console.session.lose_operator()
        if self in self.console.clients:
            self.console.clients.remove(self)

    async def on_message(self, message: str | bytes) -> None:
        try:
            asked = json.loads(message)
            if not isinstance(asked, dict):
                raise InputError("a message to the console is an object with 'do'")
            if self.console.clients[:1] != [self] and asked.get("do") != "stop":
                raise InputError("another browser is in control; this one watches, and may stop the arms")
            await asyncio.get_running_loop().run_in_executor(self.console.workers, self.console.act, asked)
            self.tell({"error": ""})
        except InputError as error:
            self.tell({"error": str(error)})
        except (ValueError, RecursionError):
            self.tell({"error": "a message to the console must be JSON"})

    def tell(self, what: dict[str, Any]) -> None:
        try:
            self.write_message(json.dumps(what, allow_nan=False))
        except tornado.websocket.WebSocketClosedError:
            self.on_close()
