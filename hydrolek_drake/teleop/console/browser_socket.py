"""The web socket of one browser."""

import asyncio
import json
import logging
from typing import Any

import tornado.websocket

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.console import messages
from hydrolek_drake.teleop.console.desk import Desk

_LOG = logging.getLogger(__name__)

_WAITING = 32  # messages of one browser that wait for their turn


class Socket(tornado.websocket.WebSocketHandler):
    """One browser. STOP is heeded at once, whoever sends it; all else in its order, from the one in control."""

    def initialize(self, console: Desk) -> None:
        """What the application hands to each request."""
        self.console, self.trusted = console, False
        self._waiting: asyncio.Queue[tuple[int, messages.AnyMessage]] = asyncio.Queue(_WAITING)
        self._worker: asyncio.Task[None] | None = None
        self._stopping: asyncio.Task[None] | None = None
        self._sent: asyncio.Future[None] | None = None

    def prepare(self) -> None:
        """Refuse what comes under a foreign name or from a foreign page, and too many browsers."""
        headers, gate = self.request.headers, self.console.gate
        reason = gate.refused_host(headers.get("Host", ""))
        if not reason and "Origin" in headers:
            reason = gate.refused_origin(headers["Origin"], headers["Host"])
        browsers = self.console.seats.browsers
        if not reason and len(browsers) >= self.console.most:
            stranger = next((each for each in browsers if not each.trusted), None)
            if stranger is None:
                reason = "too many browsers watch; close one"
            else:  # strangers must not keep an operator from STOP
                self.console.seats.leave(stranger)
                stranger.close()
        if reason:
            self.set_status(403)
            self.finish(reason + "\n")

    def check_origin(self, origin: str) -> bool:
        """Nothing is left to check."""
        return True  # `prepare` has refused all others

    def open(self, *_args: str) -> None:
        """A browser has connected."""
        self.console.seats.enter(self)
        self._worker = asyncio.ensure_future(self._carry_out())

    def on_close(self) -> None:
        """It has gone."""
        self.console.seats.leave(self)
        if self._worker is not None:
            self._worker.cancel()

    def on_message(self, message: str | bytes) -> None:
        """Heed STOP at once, keep the rest in its order, or answer why not."""
        try:
            asked = messages.parse(message)
            self.console.seats.heard(self)
            match asked:
                case messages.Stop():
                    self.console.stops += 1
                    self._stopping = asyncio.ensure_future(self._stop())
                case messages.Here():
                    pass
                case messages.Token(token=token):
                    self._show(token)
                case _:
                    self._refuse_unless_in_control()
                    self._waiting.put_nowait((self.console.stops, asked))
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
        """Send something; what is lost with the connection is no loss."""
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
            stops, asked = await self._waiting.get()
            if stops != self.console.stops:
                self.tell({"error": "not done: STOP came after it"})
                continue
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
