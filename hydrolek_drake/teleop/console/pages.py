"""What the console serves over HTTP: its page, scripts and pictures."""

from importlib.resources import files
from typing import Any

import tornado.web

from hydrolek_drake.teleop.console.desk import Desk


class Handler(tornado.web.RequestHandler):
    """Answers only under names that the console is served as."""

    def initialize(self, console: Desk) -> None:
        """What the application hands to each request."""
        self.console = console

    def set_default_headers(self) -> None:
        """Nothing is kept, guessed, or told to others."""
        self.set_header("Cache-Control", "no-store")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Referrer-Policy", "no-referrer")
        self.clear_header("Server")

    def prepare(self) -> None:
        """Refuse what comes under a foreign name."""
        reason = self.console.gate.refused_host(self.request.headers.get("Host", ""))
        if reason:
            self.set_status(403)
            self.finish(reason + "\n")

    def write_error(self, status_code: int, **kwargs: Any) -> None:
        """One line."""
        self.finish(f"{status_code} {self._reason}\n")


class Nothing(Handler):
    """Any other address."""

    def get(self) -> None:
        """Answer."""
        self.set_status(404)
        self.finish("the console has no such page\n")


class Page(Handler):
    """The page."""

    def get(self) -> None:
        """Answer."""
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


class Script(Handler):
    """Its scripts."""

    def get(self, name: str) -> None:
        """Answer."""
        self.set_header("Content-Type", "text/javascript; charset=utf-8")
        self.finish(files(__package__).joinpath(f"{name}.js").read_text(encoding="utf-8"))


class Icon(Handler):
    """Its icon."""

    def get(self) -> None:
        """Answer."""
        self.set_header("Content-Type", "image/svg+xml")
        self.finish(files(__package__).joinpath("icon.svg").read_text(encoding="utf-8"))


class Picture(Handler):
    """Camera and edges, as JPEG; over a network with the token alone."""

    def get(self, name: str) -> None:
        """Answer."""
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
