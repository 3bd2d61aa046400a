"""Who may speak to a server: loopback or network, and tokens."""

import hmac
import ipaddress
import secrets

SHORTEST_TOKEN = 16
"""Characters of a token that a user chooses."""

_TOKEN_BYTES = 18  # 144 bits: not to be guessed


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches an address or name that a server listens at."""
    if host == "localhost":
        return True
    return is_address(host) and ipaddress.ip_address(host).is_loopback


def is_address(host: str) -> bool:
    """Whether this is an IP address rather than a name."""
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


def new_token() -> str:
    """A token that nobody guesses, of letters, digits, `-` and `_`."""
    return secrets.token_urlsafe(_TOKEN_BYTES)


def same_token(given: str, token: str) -> bool:
    """Whether a token is the right one, in a time that does not tell how much of it is."""
    return hmac.compare_digest(given.encode("utf-8", errors="replace"), token.encode())


def page_address(host: str, port: int, token: str) -> str:
    """Where a browser on this machine finds a page that is served at `host`, with the token behind the #.

    What stands there is sent to no server and stands in no log.
    """
    name = {"": "127.0.0.1", "0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(
        host, f"[{host}]" if ":" in host else host
    )
    return f"http://{name}:{port}/#token={token}"
