"""Signals and innovations for Foxglove: each joint a topic of JSON messages, served at the loopback address."""

import importlib.util
import json
from collections.abc import Sequence
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.rollout.kernel import PULLED
from hydrolek_drake.watching.live.following import Follower, Observed

_HOST = "127.0.0.1"
_NS = 1_000_000_000


def _schema(name: str, fields: Sequence[str]) -> dict[str, Any]:
    return {"type": "object", "title": name, "properties": {field: {"type": "number"} for field in fields}}


_SIGNALS = ("command", *PULLED, *(f"{name}_modelled" for name in PULLED))
_INNOVATIONS = tuple(PULLED)


class FoxgloveServer:
    """A Foxglove server: `/<joint>/signals` in SI and `/<joint>/innovations` over the reference's, `/alarm` as text.

    Attributes:
        port: where it listens.
    """

    def __init__(self, joints: Sequence[str], port: int) -> None:
        """Listen.

        Args:
            joints: in the order of the rows.
            port: 0 for any free one.

        Raises:
            InputError: the package is not installed, or the port cannot be listened at.
        """
        if importlib.util.find_spec("foxglove") is None:
            raise InputError(
                "--foxglove needs a package that is not installed: pip install 'hydrolek-drake[foxglove]'"
            )
        import foxglove

        self._context = context = foxglove.Context()  # kept: its channels end with it
        self._signals = [
            foxglove.Channel(f"/{joint}/signals", schema=_schema("Signals", _SIGNALS), context=context)
            for joint in joints
        ]
        self._innovations = [
            foxglove.Channel(
                f"/{joint}/innovations", schema=_schema("Innovations", _INNOVATIONS), context=context
            )
            for joint in joints
        ]
        told = {"type": "object", "title": "Alarm", "properties": {"text": {"type": "string"}}}
        self._alarm = foxglove.Channel("/alarm", schema=told, context=context)
        try:
            self._server = foxglove.start_server(
                name="hydrolek watch", host=_HOST, port=port, context=context
            )
        except Exception as error:  # of a type of its own
            raise InputError(
                f"--foxglove {port}: cannot listen there: {error}; choose another port"
            ) from None
        self.port: int = self._server.port

    def publish(self, sample: Observed) -> None:
        """Send a sample, stamped with the stream's time."""
        stamp = round(sample.time * _NS)
        if stamp < 0:
            return  # its clock knows no time before 1970
        for joint, (signals, innovations) in enumerate(zip(self._signals, self._innovations, strict=True)):
            if signals.has_sinks():
                values = [sample.volts[joint], *sample.measured[joint], *sample.modelled[joint]]
                signals.log(_message(_SIGNALS, values), log_time=stamp)
            if innovations.has_sinks():
                innovations.log(_message(_INNOVATIONS, sample.innovations[joint]), log_time=stamp)

    def tell(self, follower: Follower, alarms: Sequence[str]) -> None:
        """Send the alarm as it stands."""
        if follower.observer.time is not None and follower.observer.time >= 0.0:
            self._alarm.log(
                json.dumps({"text": " ".join(alarms)}), log_time=round(follower.observer.time * _NS)
            )

    def close(self) -> None:
        """Stop it."""
        self._server.stop()


def _message(fields: Sequence[str], values: Any) -> str:
    """What is known; a value that is not is left out."""
    return json.dumps({name: float(v) for name, v in zip(fields, values, strict=True) if v == v})
