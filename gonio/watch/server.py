"""The server of the page."""

from __future__ import annotations

import socket
import sys
from http.server import ThreadingHTTPServer
from typing import TYPE_CHECKING, Any

from gonio.watch.access import Access
from gonio.watch.handler import Handler
from gonio.watch.state import Watched

if TYPE_CHECKING:
    from gonio.session import Session


class WatchServer(ThreadingHTTPServer):
    """Serves one session's page; `serve_forever` until it is shut down.

    Parameters
    ----------
    session
        What is watched.
    host, port
        Where; port 0 is any free one.

    Raises
    ------
    OSError
        When nothing can listen there.
    """

    daemon_threads = True

    def __init__(self, session: Session, host: str, port: int) -> None:
        self.watched = Watched(session)  # a port that is taken closes the server at once
        self.address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
        super().__init__((host, port), Handler)
        self.access = Access(host, self.server_port)
        self.watched.start()

    def server_close(self) -> None:
        """Close the port, and end the fit."""
        self.watched.stop()
        super().server_close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a browser that went away before it was answered."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)
