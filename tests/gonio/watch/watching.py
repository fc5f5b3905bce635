"""A watch server in a thread, asked through a real socket."""

import json
import threading
import urllib.error
import urllib.request
from time import monotonic

from gonio.session import Session
from gonio.watch import WatchServer


class Watcher:
    def __init__(self, root, host="127.0.0.1"):
        self.server = WatchServer(Session.open(root), host, 0)
        self.base = self.server.access.url.partition("/?")[0]
        threading.Thread(target=self.server.serve_forever, args=(0.05,)).start()

    def ask(self, path, method="GET", **headers):
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        request = urllib.request.Request(self.base + path, method=method, headers=named)
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                return answer.status, answer.read()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.read()

    def state(self):
        return json.loads(self.ask("/state")[1])

    def act(self, what):
        return self.ask(f"/{what}", "POST", X_Gonio_Token=self.server.access.token)[0]

    def until(self, holds):
        deadline = monotonic() + 60
        while not holds(state := self.state()):
            assert monotonic() < deadline, state
        return state

    def close(self):
        self.server.shutdown()
        self.server.server_close()
