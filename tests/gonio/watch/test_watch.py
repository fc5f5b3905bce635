"""A capture on the twin is watched through a real socket, paused, gone on with and stopped."""

import shutil
import signal
import subprocess
import sys

import pytest
from click.testing import CliRunner

from gonio.cli._main import cli
from gonio.errors import BadInputError
from gonio.session import Session
from tests.gonio.watch.watching import Watcher


@pytest.fixture
def watcher(course):
    watcher = Watcher(course[0])
    yield watcher
    watcher.close()


def test_a_capture_is_paused_gone_on_with_stopped_and_resumed_with_nothing_lost(course):
    root, seen = course
    assert (seen["pause"], seen["resume"], seen["stop"]) == (200, 200, 200)
    assert "w" in seen["paused"]["marks"]
    assert seen["code"] == 130
    assert "as wished by gonio watch" in seen["said"]
    stopped, done = seen["stopped"], seen["done"]
    assert (stopped["phase"], stopped["alive"], stopped["wish"]) == ("stopped", False, None)
    assert seen["late"] == 409
    assert seen["resumed"][1] == 0, seen["resumed"]
    assert (done["phase"], set(done["marks"])) == ("finished", {"d"})
    assert done["frames"][0] == done["frames"][1]
    with Session.open(root).journal() as journal:
        kinds = [event.kind for event in journal.events()]
    assert [k for k in kinds if k != "frame"] == [
        "begun", "homed", "paused", "resumed", "stopped", "begun", "homed", "finished",
    ]  # fmt: skip


def test_nothing_is_done_or_shown_for_who_may_not(course, watcher):
    token = watcher.server.access.token
    assert watcher.ask("/stop", "POST")[0] == 403
    assert watcher.ask(f"/stop?token={token}", "POST")[0] == 403
    assert watcher.ask("/stop", "GET", X_Gonio_Token=token)[0] == 404
    foreign = {"X_Gonio_Token": token, "Origin": "http://evil.example"}
    assert watcher.ask("/stop", "POST", **foreign)[0] == 403
    assert watcher.ask("/state", Host=f"evil.example:{watcher.server.server_port}")[0] == 403
    for path in ("/../journal.sqlite", "/%2e%2e/plan.json", "/raw/x.dng", "//etc/passwd"):
        assert watcher.ask(path)[0] == 404
    assert not (course[0] / "wish.json").exists()


def test_a_reduction_is_no_capture_to_be_paused(course, watcher):
    with Session.open(course[0]).lock():
        assert not watcher.state()["alive"]
        assert watcher.act("pause") == 409
    assert not (course[0] / "wish.json").exists()


@pytest.mark.parametrize(
    ("data", "said"),
    [("{}", "role: is missing"), ("}{", "data is not JSON"), ("3", "data: Input should be")],
)
def test_a_journal_damaged_meanwhile_is_told_in_one_line(course, tmp_path, tampered, data, said):
    root = shutil.copytree(course[0], tmp_path / "s")
    watcher = Watcher(root)
    try:
        assert watcher.ask("/state")[0] == 200
        tampered(
            root / "journal.sqlite",
            "INSERT INTO event (at_s, utc, kind, data) VALUES (9e9, ?, 'frame', ?)",
            ("2030-01-01T00:00:00+00:00", data),
        )
        status, text = watcher.ask("/state")
    finally:
        watcher.close()
    assert (status, text.count(b"\n")) == (503, 1)
    assert said in text.decode()


def test_a_taken_port_is_told_with_what_to_do(course, watcher):
    port = watcher.server.server_port
    taken = CliRunner().invoke(cli, ["watch", str(course[0]), "--port", str(port)])
    assert isinstance(taken.exception, BadInputError)
    assert f"127.0.0.1:{port}: cannot listen there" in str(taken.exception)


def test_ctrl_c_ends_watching_without_a_word(course):
    # a shell's background job hears no Ctrl-C, and hands that down
    hearing = "import signal, sys; signal.signal(2, signal.default_int_handler); "
    program = hearing + "sys.argv[0] = 'gonio'; from gonio.cli import main; main()"
    command = [sys.executable, "-c", program, "watch", str(course[0])]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as watching:
        try:
            assert "/?token=" in watching.stdout.readline()
            watching.send_signal(signal.SIGINT)
            assert watching.communicate(timeout=60) == ("", "")
        finally:
            watching.kill()
    assert watching.returncode == 0
