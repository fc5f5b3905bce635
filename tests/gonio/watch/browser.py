"""A headless chromium, told what to do over a pipe by the DevTools protocol."""

import base64
import contextlib
import fcntl
import json
import os
import subprocess
from time import monotonic

_FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--disable-extensions",
    "--no-first-run", "--remote-debugging-pipe",
)  # fmt: skip


class Page:
    """One page; what it complains of is in `complaints`."""

    def __init__(self, profile):
        # beyond 9, so that neither is overwritten while they become 3 and 4
        pipes = [*os.pipe(), *os.pipe()]
        told, tell, hear, heard = (fcntl.fcntl(fd, fcntl.F_DUPFD_CLOEXEC, 10) for fd in pipes)
        for fd in pipes:
            os.close(fd)
        wired = f'exec chromium "$@" 3<&{told} 4>&{heard}'
        self._process = subprocess.Popen(
            ["bash", "-c", wired, "-", *_FLAGS, f"--user-data-dir={profile}", "about:blank"],
            pass_fds=(told, heard), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(told)
        os.close(heard)
        self._tell, self._hear = os.fdopen(tell, "wb", 0), os.fdopen(hear, "rb")
        self._number, self._session, self.complaints = 0, None, []
        targets = self.ask("Target.getTargets")["targetInfos"]
        page = next(target["targetId"] for target in targets if target["type"] == "page")
        attached = self.ask("Target.attachToTarget", targetId=page, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Runtime", "Log", "Page"):
            self.ask(f"{domain}.enable")

    def ask(self, method, **params):
        self._number += 1
        message = {"id": self._number, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        self._tell.write(json.dumps(message).encode() + b"\0")
        while (answer := self._message()).get("id") != self._number:
            self._note(answer)
        assert "error" not in answer, answer
        return answer["result"]

    def value(self, script):
        """Return what a script is, awaited."""
        made = self.ask(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        assert "exceptionDetails" not in made, made
        return made["result"].get("value")

    def until(self, script):
        """Return what a script is as soon as that is true."""
        deadline = monotonic() + 60
        while not (value := self.value(script)):
            assert monotonic() < deadline, (script, self.complaints)
        return value

    def look(self, width, scheme):
        """Return the whole page as PNG, at a width in px, light or dark."""
        self.ask(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-color-scheme", "value": scheme}],
        )
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        self.ask("Emulation.setDeviceMetricsOverride", **size)
        shot = self.ask("Page.captureScreenshot", captureBeyondViewport=True)
        return base64.b64decode(shot["data"])

    def close(self):
        with contextlib.suppress(OSError):
            self.ask("Page.close")
        self._process.terminate()
        self._process.wait(20)
        self._tell.close()
        self._hear.close()

    def _message(self):
        read = bytearray()
        while (byte := self._hear.read(1)) != b"\0":
            assert byte, "chromium has gone"
            read += byte
        return json.loads(read)

    def _note(self, event):
        params = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            self.complaints.append(params["exceptionDetails"])
        if event.get("method") == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.complaints.append(params["entry"])
        if event.get("method") == "Runtime.consoleAPICalled" and params["type"] == "error":
            self.complaints.append(params)
