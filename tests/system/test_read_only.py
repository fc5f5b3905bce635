"""A session that can only be read, as from an archive: what is possible, and what is said."""

import os
import shutil
import signal
import subprocess
import sys

import pytest

from gonio.files import sha256_file

NETWORK = ("--estimator", "paper", "--epochs", "2")


@pytest.fixture
def reader(tmp_path):
    """Run `gonio`, or another program, without the power of root to write where it may not."""
    tame = []
    if os.geteuid() == 0:
        if not shutil.which("setpriv"):
            pytest.skip("needs setpriv, or a user who is not root")
        tame = ["setpriv", "--bounding-set=-dac_override"]

    def run(*arguments, program=("-m", "gonio")):
        return subprocess.run(
            [*tame, sys.executable, *program, *map(str, arguments)],
            cwd=tmp_path,
            env=os.environ | {"COLUMNS": "120", "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


def captured(gonio, root):
    for command in (
        ("plan", "--density", "3", "--criterion", "farthest", "--no-page"),
        ("capture", "--sim", "-o", root),
    ):
        done = gonio(*command)
        assert done.returncode == 0, done.stderr


@pytest.fixture
def frozen(tmp_path):
    """Forbid to write to a session, until the test is over."""
    changed = []

    def freeze(root):
        for path in (root, *root.rglob("*")):
            changed.append((path, path.stat().st_mode))
            path.chmod(0o555 if path.is_dir() else 0o444)
        return {path: sha256_file(path) for path in root.rglob("*") if path.is_file()}

    yield freeze
    for path, mode in changed:
        path.chmod(mode)


def test_a_reduced_session_is_reconstructed_elsewhere(gonio, reader, frozen, tmp_path):
    session = tmp_path / "session"
    captured(gonio, "session")
    assert gonio("reduce").returncode == 0
    before = frozen(session)
    done = reader("reconstruct", *NETWORK, "-o", "elsewhere")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "elsewhere/report.html").is_file()
    assert (tmp_path / "elsewhere/model.json").is_file()
    assert {path: sha256_file(path) for path in before} == before


REFUSED = {
    "a model in it": (("reconstruct", *NETWORK), "name a folder for the model with -o"),
    "samples in it": (("reconstruct", *NETWORK, "-o", "m"), "copy it to a folder that can be"),
    "a reduction": (("reduce",), "copy it to a folder that can be written, and reduce the copy"),
    "frames in it": (("capture", "--sim", "--resume"), "the folder and its permissions"),
}


def test_what_would_write_into_it_is_refused_in_one_line(gonio, reader, frozen, tmp_path):
    captured(gonio, "session")
    before = frozen(tmp_path / "session")
    for command, says in REFUSED.values():
        refused = reader(*command)
        assert (refused.returncode, refused.stdout) == (3, "")
        assert says in refused.stderr
        assert len(refused.stderr.splitlines()) == 1
    files = {path for path in (tmp_path / "session").rglob("*") if path.is_file()}
    assert files == before.keys()


def test_a_model_s_folder_is_tried_before_the_training(reader, frozen, tmp_path):
    for name in ("locked", "locked/model"):
        (tmp_path / name).mkdir()
    header = "light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg,y"
    # too few to be trained on, which would be said after the folder was found good
    (tmp_path / "table.csv").write_text(f"{header}\n0,0,30,0,0.1\n")
    frozen(tmp_path / "locked")
    for folder in ("locked/model", "locked/new", "locked/new/deeper"):
        refused = reader("reconstruct", "table.csv", "-o", folder)
        assert (refused.returncode, refused.stdout) == (3, "")
        assert "Permission denied" in refused.stderr
        assert len(refused.stderr.splitlines()) == 1


WRITE_AND_DIE = """
import os, signal, sys
from pathlib import Path
from gonio.clock import VirtualClock
from gonio.journal import Journal
journal = Journal(Path(sys.argv[1]), writing=True)
journal.append(VirtualClock(), "begun")
os.kill(os.getpid(), signal.SIGKILL)
"""
READ = """
import sys
from pathlib import Path
from gonio.journal import Journal
with Journal(Path(sys.argv[1])) as journal:
    print([event.kind for event in journal.events()])
"""


def test_what_a_killed_capture_left_ahead_of_the_journal_is_read(tmp_path, reader, frozen):
    """Its newest rows are not yet in journal.sqlite itself."""
    path = tmp_path / "archive/journal.sqlite"
    path.parent.mkdir()
    died = reader(path, program=("-c", WRITE_AND_DIE))
    assert died.returncode == -signal.SIGKILL
    before = frozen(path.parent)
    assert {file.name for file in before} >= {"journal.sqlite", "journal.sqlite-wal"}
    done = reader(path, program=("-c", READ))
    assert (done.stdout, done.stderr) == ("['begun']\n", "")
