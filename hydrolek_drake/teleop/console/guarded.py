"""Requests that are answered only under names that a page is served as: the console's, and a live watch's."""

from importlib.resources import files
from typing import Any

import tornado.web

from hydrolek_drake.teleop.console.gate import Gate


class Guarded(tornado.web.RequestHandler):
    """Answers only under names that its gate lets in.

    Attributes:
        gate: set by `initialize` of what derives from it.
        foreign: what a request under another name is told; empty for the gate's own reason.
    """

    gate: Gate
    foreign = ""

    def set_default_headers(self) -> None:
        """Nothing is kept, guessed, or told to others."""
        self.set_header("Cache-Control", "no-store")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Referrer-Policy", "no-referrer")
        self.clear_header("Server")

    def prepare(self) -> None:
        """Refuse what comes under a foreign name."""
        reason = self.gate.refused_host(self.request.headers.get("Host", ""))
        if reason:
            self.refuse(403, self.foreign or reason)

    def write_error(self, status_code: int, **kwargs: Any) -> None:
        """One line."""
        self.finish(f"{status_code} {self._reason}\n")

    def refuse(self, status: int, reason: str) -> None:
        """Answer with a status and one line."""
        self.set_status(status)
        self.finish(reason + "\n")

    def give_file(self, package: str, name: str, kind: str) -> None:
        """Answer with a text file that comes with a package.

        Args:
            package: where it lies.
            name: of the file.
            kind: its MIME type.
        """
        self.set_header("Content-Type", kind)
        self.finish(files(package).joinpath(name).read_text(encoding="utf-8"))
