"""A capture over a real TCP port or pseudo-terminal, a real serial line and a real folder."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time

import pytest

from gonio.session import Session


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def refused(result, code, says):
    assert (result.returncode, result.stderr.count("\n")) == (code, 1), result.stderr
    assert says in result.stderr


@pytest.fixture
def plan(gonio, served):
    ok(gonio("plan", "--density", "2", "--criterion", "farthest", "--rig", served.rig, "--no-page"))


def test_a_whole_capture(gonio, tmp_path, served, plan):
    said = ok(gonio("capture", "--rig", served.rig, "--sample", "felt"))
    assert "frames of felt in" in said
    session = Session(tmp_path / "session")
    assert session.notes().sample == "felt"
    assert not session.sim.exists()
    ok(gonio("reduce"))
    assert "nothing left to take" in ok(gonio("capture", "--resume"))
    refused(gonio("capture", "--resume", "--sim"), 2, "was not made with --sim")


@pytest.fixture
def start(tmp_path):
    started = []

    def run(*arguments):
        started.append(process_of(tmp_path, arguments))
        return started[-1]

    yield run
    for process in started:
        process.kill()
        process.communicate()


# a shell's background job ignores Ctrl-C, and so would its children
PROGRAM = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
from gonio.cli import main
main()
"""


def process_of(tmp_path, arguments):
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *map(str, arguments)],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )  # fmt: skip


def wait_for_frames(session, count):
    while len(list((session / "calibration").glob("*.dng"))) < count:
        time.sleep(0.01)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_capture_that_is_stopped_stops_the_rig_within_a_second_and_goes_on(
    gonio, tmp_path, served, plan, start, number, code
):
    process = start("capture", "--rig", served.rig)
    wait_for_frames(tmp_path / "session", 3)
    process.send_signal(number)
    began = time.monotonic()
    _, said = process.communicate(timeout=30)
    assert process.returncode == code
    assert "go on with: gonio capture --resume" in said
    assert time.monotonic() - began < 5.0  # until the process is gone
    check = ok(gonio("rig", "check", "--rig", served.rig))
    assert check.count("switch on disabled") == 4
    assert "none" in check
    ok(gonio("capture", "--resume"))
    with Session(tmp_path / "session").journal() as journal:
        keys = [record.key for record in journal.frames()]
    assert len(keys) == len({*keys}) == 24


def test_a_second_process_is_refused_and_a_stop_ends_the_first(
    gonio, tmp_path, served, plan, start
):
    process = start("capture", "--rig", served.rig, "-o", "first")
    wait_for_frames(tmp_path / "first", 2)
    says = f"another gonio drives this rig (process {process.pid})"
    refused(gonio("capture", "--rig", served.rig, "-o", "second"), 2, says)
    refused(gonio("rig", "home", "--rig", served.rig), 2, says)
    stopped = ok(gonio("rig", "stop", "--rig", served.rig))
    assert f"process {process.pid}, which drove the rig, has ended" in stopped
    process.communicate()
    assert process.returncode == 143
    ok(gonio("capture", "--resume", "-o", "first"))


def test_a_door_and_a_power_cut_on_the_way_are_survived(gonio, tmp_path, served, plan, start):
    process = start("capture", "--rig", served.rig)
    wait_for_frames(tmp_path / "session", 4)
    served.tell("door", "open")
    served.tell("door", "closed")
    served.tell("power", "off")
    served.tell("power", "on")
    _, said = process.communicate(timeout=120)
    assert process.returncode == 0, said
    with sqlite3.connect(tmp_path / "session/journal.sqlite") as journal:
        rows = journal.execute("SELECT data FROM event WHERE kind = 'fault'").fetchall()
    assert rows, "neither was noticed"
    assert all(json.loads(data)["did"] for (data,) in rows)


def test_a_rig_that_is_not_there(gonio, tmp_path, served):
    text = served.rig.read_text()
    rig = tmp_path / "gone.toml"
    rig.write_text(text.replace(str(served.folder / "lamps"), "/dev/nothing-here"))
    ok(gonio("plan", "--density", "2", "--criterion", "farthest", "--rig", rig, "--no-page"))
    result = gonio("rig", "check", "--rig", rig)
    assert result.returncode == 3
    assert "plug it in" in " ".join(result.stdout.split())


def test_it_asks_which_rig_and_knows_what_is_the_twins(gonio, served):
    refused(gonio("capture"), 2, "which rig? give its file with --rig, or add --sim")
    refused(gonio("capture", "--rig", served.rig, "--seed", "3"), 2, "--seed is an option of --sim")


def test_a_person_needs_a_terminal(gonio, tmp_path, manual_rig):
    ok(gonio("plan", "--density", "2", "--criterion", "farthest", "--rig", manual_rig, "--no-page"))
    refused(gonio("capture", "--rig", manual_rig), 2, "this is no terminal to ask at")
    assert not (tmp_path / "session").exists()
