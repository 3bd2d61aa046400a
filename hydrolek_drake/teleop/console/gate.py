"""Which requests the console answers at all: names it is served under, origins of web sockets, the token."""

import urllib.parse

from hydrolek_drake.teleop.access import is_address, is_loopback, same_token

_EVERYWHERE = ("", "0.0.0.0", "::")


class Gate:
    """Keeps pages of other sites from speaking to the console through the operator's own browser.

    A page of a foreign site can have its name resolved to this machine (DNS rebinding); its requests then arrive with
    that name as `Host`, and with an `Origin` that matches it. So a name counts only if the console was told to be
    served under it. An address in numbers cannot be rebound: whoever sends it has loaded the page from this server.

    Args:
        host: Address that the console listens at.
        allowed: Further names, such as that of a proxy before it.
        token: What control needs, and watching too where the console is bound to a network.
    """

    def __init__(self, host: str, allowed: tuple[str, ...], token: str) -> None:
        self._host, self._token = host.lower(), token
        self._allowed = {_without_dot(name) for name in allowed}
        self.watching_is_free = is_loopback(host)

    def refused_host(self, header: str) -> str:
        """Why a request with this `Host` header is not answered, or empty."""
        name = _name(header)
        if name is not None and self._is_served(name):
            return ""
        return f"the console is not served as {header[:80]!r}; start it with --allow-host NAME to reach it by that name"

    def refused_origin(self, origin: str, header: str) -> str:
        """Why a web socket of a page of this `Origin` is not opened, or empty."""
        try:
            parts = urllib.parse.urlsplit(origin.lower())
            name = parts.hostname
        except ValueError:
            name = None
        same = name is not None and parts.netloc == header.lower()
        if name is not None and (same or _without_dot(name) in self._allowed):
            return ""
        return f"a page of {origin[:80]!r} may not speak to this console"

    def trusts(self, token: str) -> bool:
        """Whether this is the token."""
        return same_token(token, self._token)

    def _is_served(self, name: str) -> bool:
        if name in self._allowed or name == self._host:
            return True
        if self.watching_is_free:
            return is_loopback(name)
        return self._host in _EVERYWHERE and (is_address(name) or name == "localhost")


def _name(header: str) -> str | None:
    try:
        name = urllib.parse.urlsplit(f"//{header}").hostname
    except ValueError:
        return None
    plain = header.rpartition(":")[0] if header.rpartition(":")[2].isdigit() else header
    if name is None or plain.strip("[]").lower() != name:  # user:password@, paths and the like
        return None
    return _without_dot(name)


def _without_dot(name: str) -> str:
    return name.lower().removesuffix(".")
