"""One request for the page, for what it shows, or to leave a wish."""

from __future__ import annotations

import json
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import parse_qs, urlsplit

from gonio.errors import GonioError
from gonio.watch.page import page
from gonio.watch.state import WISHES

if TYPE_CHECKING:
    from collections.abc import Callable
    from urllib.parse import SplitResult

    from gonio.watch.server import WatchServer


class _Answer(NamedTuple):
    status: HTTPStatus
    kind: str
    data: bytes


class Handler(BaseHTTPRequestHandler):
    """Answers one connection; whatever goes wrong is told as one line."""

    server: WatchServer
    timeout = 10
    server_version, sys_version = "gonio", ""

    def do_GET(self) -> None:
        """Show something."""
        self._guarded(self._shown, acts=False)

    def do_POST(self) -> None:
        """Leave a wish."""
        self._guarded(self._left, acts=True)

    def _guarded(self, answer: Callable[[str], _Answer], *, acts: bool) -> None:
        try:
            asked = urlsplit(self.path)
        except ValueError:
            return self._send(_said(HTTPStatus.BAD_REQUEST, "that is no address"))
        if refusal := self._refusal(asked, acts=acts):
            return self._send(_said(HTTPStatus.FORBIDDEN, refusal))
        try:
            made = answer(asked.path)
        except (GonioError, OSError) as error:
            made = _said(HTTPStatus.SERVICE_UNAVAILABLE, str(error))
        return self._send(made)

    def _refusal(self, asked: SplitResult, *, acts: bool) -> str | None:
        token = self.headers["X-Gonio-Token"]
        if not (token or acts):
            token = parse_qs(asked.query).get("token", [None])[0]
        return self.server.access.refusal(
            host=self.headers["Host"],
            origin=self.headers["Origin"],
            site=None if asked.path == "/" else self.headers["Sec-Fetch-Site"],
            token=token,
            acts=acts,
        )

    def _shown(self, path: str) -> _Answer:
        watched = self.server.watched
        if path == "/":
            return _Answer(HTTPStatus.OK, "text/html; charset=utf-8", page().html)
        if path in ("/state", "/route"):
            value = watched.state() if path == "/state" else watched.route()
            return _Answer(HTTPStatus.OK, "application/json", json.dumps(value).encode())
        pictures = {"/frame.png": watched.frame, "/fit.png": watched.sphere}
        if path in pictures and (data := pictures[path]()):
            return _Answer(HTTPStatus.OK, "image/png", data)
        return _said(HTTPStatus.NOT_FOUND, "there is no such thing")

    def _left(self, path: str) -> _Answer:
        what = path.removeprefix("/")
        if what not in WISHES:
            return _said(HTTPStatus.NOT_FOUND, "there is no such thing")
        if refusal := self.server.watched.want(what):
            return _said(HTTPStatus.CONFLICT, refusal)
        return _said(HTTPStatus.OK, "told")

    def _send(self, answer: _Answer) -> None:
        self.send_response(answer.status)
        for name, value in {
            "Content-Type": answer.kind,
            "Content-Length": str(len(answer.data)),
            "Content-Security-Policy": page().policy,
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cache-Control": "no-store",
        }.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(answer.data)

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the base's name
        """Say nothing: the terminal is for the address."""


def _said(status: HTTPStatus, text: str) -> _Answer:
    return _Answer(status, "text/plain; charset=utf-8", f"{text}\n".encode())
