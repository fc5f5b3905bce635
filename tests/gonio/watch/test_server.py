"""What a server answers that watches a session in which nothing happened yet."""

import contextlib
import socket

import pytest

from gonio.creation import create_session
from gonio.notes import Notes
from gonio.rig import default_rig, default_rig_text
from planner.make import make_plan
from tests.gonio.watch.watching import Watcher

NOTES = Notes(sample="a", orientation="b", mounting="c", operator="d")


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    plan = make_plan(default_rig(), views=2, lights=2)
    return create_session(tmp_path_factory.mktemp("s") / "s", plan, default_rig_text(), NOTES)


@pytest.fixture(scope="module")
def watcher(session):
    with contextlib.closing(Watcher(session.root)) as watcher:
        yield watcher


@pytest.mark.parametrize("method", ["GET", "POST"])
def test_what_is_no_address_is_told_so(watcher, method, capfd):
    with socket.create_connection(("127.0.0.1", watcher.server.server_port), 30) as asking:
        asking.sendall(f"{method} http://[ HTTP/1.0\r\n\r\n".encode())
        assert asking.makefile("rb").readline().split()[1:2] == [b"400"]
    assert capfd.readouterr().err == ""
