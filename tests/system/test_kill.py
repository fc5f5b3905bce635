"""A capture that is killed for real, at any moment, goes on and loses nothing."""

import os
import signal
import sqlite3
import subprocess
import sys

import pytest

from gonio.files import sha256_file

# a plan of 2 x 2 takes 32 dark and white frames, then 4 x 4
MOMENTS = {"among the dark frames": 3, "in the first shot": 34, "in the last shot": 46}


def frames(session):
    if not (session / "journal.sqlite").exists():
        return 0
    with sqlite3.connect(f"file:{session / 'journal.sqlite'}?mode=ro", uri=True) as journal:
        try:
            ((count,),) = journal.execute("SELECT COUNT(*) FROM event WHERE kind = 'frame'")
        except sqlite3.OperationalError:  # not laid out yet, or about to be
            return 0
    journal.close()
    return count


def kill_at(folder, plan, session, count):
    process = subprocess.Popen(
        [sys.executable, "-m", "gonio", "capture", "--sim", "--plan", plan, "-o", session],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    while process.poll() is None and frames(session) < count:
        os.sched_yield()
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert process.returncode == -signal.SIGKILL


@pytest.fixture
def plan(gonio, tmp_path):
    assert gonio("plan", "--density", "2", "-o", "plan.json").returncode == 0
    return tmp_path / "plan.json"


@pytest.mark.parametrize("count", MOMENTS.values(), ids=MOMENTS)
def test_nothing_is_lost(gonio, tmp_path, plan, count):
    killed = tmp_path / "killed"
    kill_at(tmp_path, plan, killed, count)
    kept = {path: sha256_file(path) for path in (killed / "raw").iterdir() if path.suffix == ".dng"}
    refused = gonio("capture", "--sim", "--plan", plan, "-o", "killed")
    assert refused.returncode == 2
    assert "--resume" in refused.stderr
    resumed = gonio("capture", "--sim", "--resume", "-o", "killed")
    assert (resumed.returncode, resumed.stderr) == (0, "")
    assert frames(killed) >= 48
    assert all(sha256_file(path) == digest for path, digest in kept.items())
    reconstructed = gonio("reconstruct", "killed", "--estimator", "paper", "--epochs", "2")
    # four shots are fewer than a network needs: what counts is that all of them are there
    assert "there are 4 samples" in reconstructed.stderr
    assert "complete" in gonio("capture", "--sim", "--resume", "-o", "killed").stdout
