"""One capture on the twin for all, paused, gone on with, stopped and resumed while watched."""

import contextlib
import os
import subprocess
import sys
from time import monotonic

import pytest

from gonio.rig import default_rig_text
from tests.gonio.watch.watching import Watcher

RIG = default_rig_text().replace("[0.002, 0.02, 0.2, 2.0]", "[0.02, 0.2]")


@pytest.fixture(scope="package")
def planned(tmp_path_factory):
    """Return a folder with a plan of 16 shots, and what starts a gonio there."""
    folder = tmp_path_factory.mktemp("watch")

    def run(*arguments):
        return subprocess.Popen(
            [sys.executable, "-m", "gonio", *arguments], cwd=folder, env=os.environ,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip

    (folder / "rig.toml").write_text(RIG)
    plan = ("plan", "--density", "4", "--criterion", "farthest", "--rig", "rig.toml", "--no-page")
    with run(*plan) as planning:
        assert planning.communicate()[1] == ""
    return folder, run


@pytest.fixture(scope="package")
def begin(planned):
    """Return what begins a capture into a folder, and a watcher as soon as there is a journal."""
    folder, run = planned

    @contextlib.contextmanager
    def begin(name):
        arguments = ("capture", "--sim", "--plan", "plan.json", "--rig", "rig.toml", "-o", name)
        with run(*arguments) as capture:
            try:
                deadline = monotonic() + 60
                while not (folder / name / "journal.sqlite").exists():
                    assert monotonic() < deadline
                    assert capture.poll() is None
                with contextlib.closing(Watcher(folder / name)) as watcher:
                    yield capture, watcher
            finally:
                capture.kill()

    return begin


@pytest.fixture(scope="package")
def course(planned, begin):
    """Return the folder of a session, and what was seen of it."""
    seen = {}
    with begin("s") as (capture, watcher):
        watcher.until(lambda state: state["alive"])
        seen["pause"] = watcher.act("pause")
        seen["paused"] = watcher.until(lambda state: state["phase"] == "paused")
        seen["resume"] = watcher.act("resume")
        watcher.until(lambda state: state["phase"] != "paused")
        seen["stop"] = watcher.act("stop")
        seen["said"] = capture.communicate(timeout=60)[1]
        seen["code"] = capture.returncode
        seen["stopped"], seen["late"] = watcher.state(), watcher.act("pause")
        with planned[1]("capture", "--sim", "--resume", "-o", "s") as resumed:
            seen["resumed"] = (resumed.communicate(timeout=60)[1], resumed.returncode)
        seen["done"] = watcher.state()
    return planned[0] / "s", seen
