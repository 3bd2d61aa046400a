"""The meshcat package's server, for this machine only.

The package's own `meshcat-server` answers to the whole network; this one binds to the loopback address.
"""

import asyncio
import contextlib
import io
import threading
from collections.abc import Iterator
from functools import partial

import meshcat
import tornado.ioloop
import tornado.web
from meshcat.servers.zmqserver import ZMQWebSocketBridge


class _LoopbackBridge(ZMQWebSocketBridge):
    def make_app(self) -> tornado.web.Application:
        app = super().make_app()
        app.listen = partial(app.listen, address=self.host)
        return app


@contextlib.contextmanager
def loopback_visualizer() -> Iterator[meshcat.Visualizer]:
    """A visualizer whose server runs in a thread of this process until the context is left."""
    started = threading.Event()
    bridges: list[_LoopbackBridge] = []

    def serve() -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        tornado.ioloop.IOLoop.current()
        bridges.append(_LoopbackBridge())
        started.set()
        bridges[0].run()

    thread = threading.Thread(target=serve, name="meshcat", daemon=True)
    thread.start()
    started.wait()
    with contextlib.redirect_stdout(io.StringIO()):  # it prints its address, which the caller may not want
        visualizer = meshcat.Visualizer(zmq_url=bridges[0].zmq_url)
    try:
        yield visualizer
    finally:
        bridges[0].ioloop.add_callback(bridges[0].ioloop.stop)
        thread.join(timeout=5.0)
