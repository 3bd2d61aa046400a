"""The console's end of a link that may be lost, and is sought again."""

import time

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.link.client import SetpointClient

Array = NDArray[np.float64]


class ReconnectingClient:
    """A client that can be had anew, from the same controllers' end, each `link.again` seconds of teleop.yaml.

    It is not locked: who calls `lose` and `regain` keeps others from the client meanwhile.

    Args:
        controllers: Host and port of the controllers' end.
        realtime_rate: Simulated seconds a second, of a simulated machine.
        token: What the controllers' end asks for, if it does.

    Attributes:
        client: What sends; None while the link is lost.
        lost: Why the link is lost; empty while it stands.

    Raises:
        InputError: Nobody answers, or the token is refused.
    """

    def __init__(
        self, controllers: tuple[str, int], *, realtime_rate: float = 1.0, token: str | None = None
    ) -> None:
        self._controllers, self._rate, self._token = controllers, realtime_rate, token
        self._again_at = 0.0
        self.client: SetpointClient | None = self._connected()
        self.lost = ""

    def lose(self, reason: str) -> None:
        """The link is lost."""
        self.close()
        self.lost, self.client = reason, None

    def wait(self) -> None:
        """Seek it no earlier than `link.again` seconds from now."""
        self._again_at = time.monotonic() + teleop_entries("link")["again"]

    def seek(self) -> tuple[SetpointClient, Array] | None:
        """Ask for the link anew, if it is time to; it is lost until `regain` is called.

        Returns:
            A client in control, and the measured angles in rad, shape (14,); None if it cannot be had yet.
        """
        if time.monotonic() < self._again_at:
            return None
        client = None
        try:
            client = self._connected()
            return client, client.control()
        except InputError:
            if client is not None:
                client.close()
            self.wait()
            return None

    def regain(self, client: SetpointClient) -> None:
        """The link stands again, by a client of `seek`."""
        self.client, self.lost = client, ""

    def close(self) -> None:
        """Close the connection, if there is one."""
        if self.client is not None:
            self.client.close()

    def _connected(self) -> SetpointClient:
        host, port = self._controllers
        return SetpointClient(port, host, realtime_rate=self._rate, token=self._token)
