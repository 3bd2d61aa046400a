"""Signals and innovations for Foxglove, read back by its own protocol."""

import asyncio
import json
import struct

import numpy as np
import pytest
import tornado.websocket

from hydrolek_drake.errors import InputError
from hydrolek_drake.watching.live.following import Observed
from hydrolek_drake.watching.live.publishing import FoxgloveServer

pytest.importorskip("foxglove")

SAMPLE = Observed(
    1,
    12.5,
    np.array([3.0]),
    np.array([[0.5, np.nan, 2e6]]),
    np.array([[0.4, 1e6, 2e6]]),
    np.array([[1.5, np.nan, 0.0]]),
    True,
)
MESSAGE_DATA = 1


async def _publish(server):
    while True:
        server.publish(SAMPLE)
        await asyncio.sleep(0.05)


def test_a_panel_gets_signals_and_innovations():
    server = FoxgloveServer(("joint",), 0)

    async def watch():
        address = f"ws://127.0.0.1:{server.port}/"
        socket = await tornado.websocket.websocket_connect(address, subprotocols=["foxglove.sdk.v1"])
        topics = {}
        while len(topics) < 3:
            said = await socket.read_message()
            told = json.loads(said) if isinstance(said, str) else {}
            topics |= {each["topic"]: each["id"] for each in told.get("channels", [])}
        wanted = ["/joint/signals", "/joint/innovations"]
        subscriptions = [{"id": i, "channelId": topics[topic]} for i, topic in enumerate(wanted)]
        await socket.write_message(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))
        found = {}
        sending = asyncio.ensure_future(_publish(server))  # what is sent before a panel asks is not kept
        while len(found) < 2:
            said = await socket.read_message()
            if isinstance(said, bytes) and said[0] == MESSAGE_DATA:
                number, stamp = struct.unpack_from("<IQ", said, 1)
                found[wanted[number]] = (stamp, json.loads(said[13:]))
        sending.cancel()
        socket.close()
        return set(topics), found

    try:
        topics, found = asyncio.run(asyncio.wait_for(watch(), 30.0))
    finally:
        server.close()
    assert topics == {"/joint/signals", "/joint/innovations", "/alarm"}
    stamp, signals = found["/joint/signals"]
    assert stamp == 12_500_000_000
    assert signals["command"] == 3.0 and signals["reading"] == 0.5 and signals["reading_modelled"] == 0.4
    assert "pressure_a" not in signals and signals["pressure_b"] == 2e6
    assert found["/joint/innovations"][1] == {"reading": 1.5, "pressure_b": 0.0}


def test_a_port_that_is_taken_is_refused():
    server = FoxgloveServer(("joint",), 0)
    try:
        with pytest.raises(InputError, match="--foxglove"):
            FoxgloveServer(("joint",), server.port)
    finally:
        server.close()
