"""What the console serves over HTTP: its page, scripts and pictures."""

import asyncio

from hydrolek_drake.teleop.console.desk import Desk
from hydrolek_drake.teleop.console.guarded import Guarded


class Handler(Guarded):
    """Answers only under names that the console is served as."""

    def initialize(self, console: Desk) -> None:
        """What the application hands to each request."""
        self.console = console
        self.gate = console.gate


class Nothing(Handler):
    """Any other address."""

    def get(self) -> None:
        """Answer."""
        self.refuse(404, "the console has no such page")


class Page(Handler):
    """The page."""

    def get(self) -> None:
        """Answer."""
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
        self.give_file(__package__, "page.html", "text/html; charset=utf-8")


class Script(Handler):
    """Its scripts."""

    def get(self, name: str) -> None:
        """Answer."""
        self.give_file(__package__, f"{name}.js", "text/javascript; charset=utf-8")


class Icon(Handler):
    """Its icon."""

    def get(self) -> None:
        """Answer."""
        self.give_file(__package__, "icon.svg", "image/svg+xml")


class Picture(Handler):
    """Camera and edges, as JPEG; over a network with the token alone."""

    async def get(self, name: str) -> None:
        """Answer; what a click holds is waited for in a thread, so that STOP is heard meanwhile."""
        gate = self.gate
        if not gate.watching_is_free:
            scheme, _, token = self.request.headers.get("Authorization", "").partition(" ")
            if scheme != "Bearer" or not gate.trusts(token):
                self.refuse(401, "watching needs the token of the address that the console has printed")
                return
        loop, console = asyncio.get_running_loop(), self.console
        picture = await loop.run_in_executor(console.workers, console.session.picture, name)
        if not picture:
            self.set_status(204)  # there is none yet
            return
        self.set_header("Content-Type", "image/jpeg")
        self.finish(picture)
