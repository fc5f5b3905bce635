"""What a server answers that watches a session in which nothing happened yet."""

import contextlib
import socket
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest

from gonio.creation import create_session
from gonio.notes import Notes
from gonio.rig import default_rig, default_rig_text
from gonio.watch import state
from gonio.watch.following import Told
from gonio.watch.state import Watched
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


SITES = {"none": 200, "same-origin": 200, "same-site": 403, "cross-site": 403}


@pytest.mark.parametrize(("site", "status"), SITES.items(), ids=SITES)
def test_another_page_may_link_here_and_ask_for_nothing_else(watcher, site, status):
    token = watcher.server.access.token
    for path in ("/state", f"/state?token={token}"):
        assert watcher.ask(path, Sec_Fetch_Site=site)[0] == status
    assert watcher.ask(f"/?token={token}", Sec_Fetch_Site=site)[0] == 200


def test_a_frame_is_decoded_once_however_many_ask(session, monkeypatch):
    decoded, watched = [], Watched(session)
    monkeypatch.setattr(state, "frame_png", lambda root, record: decoded.append(record) or b"png")
    told = Told()
    monkeypatch.setattr(watched, "_following", SimpleNamespace(look=lambda: told))
    for record in ("first", "second"):
        told.last_frame = (1, None, record)
        with ThreadPoolExecutor(4) as pool:
            assert list(pool.map(lambda _: watched.frame(), range(8))) == [b"png"] * 8
    assert decoded == ["first", "second"]


def has_ipv6():
    try:
        with socket.socket(socket.AF_INET6) as tried:
            tried.bind(("::1", 0))
    except OSError:
        return False
    return True


@pytest.mark.skipif(not has_ipv6(), reason="needs IPv6")
def test_it_listens_at_an_address_of_ipv6(session):
    with contextlib.closing(Watcher(session.root, "::1")) as watcher:
        assert watcher.base == f"http://[::1]:{watcher.server.server_port}"
        assert watcher.state()["phase"] == "waiting"
        assert watcher.act("stop") == 409
