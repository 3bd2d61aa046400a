"""The page of a live watch: served here alone, told what is new, and it reads nothing."""

import asyncio
import json

import pytest
import tornado.httpclient
import tornado.websocket

from hydrolek_drake.errors import InputError
from hydrolek_drake.watching.live.server import LivePage

FIRST = {"title": "Live watch of x", "rows": [], "status": {}}


@pytest.fixture
def page():
    served = LivePage(0, lambda: FIRST)
    yield served
    served.close()


def _get(page, path="/", **headers):
    async def ask():
        client = tornado.httpclient.AsyncHTTPClient()
        return await client.fetch(f"http://127.0.0.1:{page.port}{path}", raise_error=False, headers=headers)

    return asyncio.run(ask())


def test_the_page_needs_nothing_from_elsewhere(page):
    answer = _get(page)
    text = answer.body.decode()
    assert answer.code == 200 and "https://" not in text and "http://" not in text
    assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
    assert _get(page, "/live.js").code == 200 and _get(page, "/server.py").code == 404


def test_pages_of_other_sites_are_kept_out(page):
    assert _get(page, Host="evil.example").code == 403
    assert _get(page, "/socket", Host=f"127.0.0.1:{page.port}", Origin="http://evil.example").code == 403


def test_a_browser_is_told_the_whole_and_then_what_is_new(page):
    async def telling():
        while True:  # one that has not taken the last message yet is not told the next
            page.tell({"rows": [[1]]})
            await asyncio.sleep(0.02)

    async def watch():
        socket = await tornado.websocket.websocket_connect(f"ws://127.0.0.1:{page.port}/socket")
        first = json.loads(await socket.read_message())
        await socket.write_message("STOP")  # which nobody heeds
        task = asyncio.ensure_future(telling())
        later = [json.loads(await socket.read_message()) for _ in range(3)]
        task.cancel()
        socket.close()
        return first, later

    first, later = asyncio.run(watch())
    assert first == FIRST and {"rows": [[1]]} in later


def test_a_port_that_is_taken_is_refused(page):
    with pytest.raises(InputError, match="choose another"):
        LivePage(page.port, lambda: FIRST)
