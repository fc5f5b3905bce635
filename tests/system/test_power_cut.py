"""A power cut is no kill: what was not synced is gone; the rest goes on, and nothing is lost."""

import os
import shutil
import subprocess
import sys

import pytest

from gonio.session import Session
from tests.system.disk import STRACE, Disk
from tests.system.test_kill import FRAMES, RIG, ok, resume, shots_of, vouched

pytestmark = pytest.mark.skipif(shutil.which("strace") is None, reason="needs strace")

VARIANTS = {
    "nothing but what was synced": ("synced", "synced"),
    "names, and of files what was synced": ("live", "synced"),
    "all that was written": ("live", "live"),
}
STRIDE = 8
"""Of the moments at which something was synced, made, renamed or removed, one in so many."""


def unfold(tree, folder):
    folder.mkdir()
    for name, content in tree.items():
        if isinstance(content, dict):
            unfold(content, folder / name)
        elif not name.endswith("-shm"):  # shared memory, which SQLite makes anew
            (folder / name).write_bytes(content)


@pytest.fixture(scope="module")
def log(forks, tmp_path_factory):
    """Return a folder as it was before a capture, and the system calls of the capture in it."""
    before = tmp_path_factory.mktemp("before")
    (before / "rig.toml").write_text(RIG)
    plan = ("--density", "2", "--criterion", "farthest", "--rig", "rig.toml", "--no-page")
    ok(forks.run(before, "plan", *plan))
    work = tmp_path_factory.mktemp("work")
    shutil.copytree(before, work, dirs_exist_ok=True)
    trace = before.parent / "trace"
    options = ("capture", "--sim", "--plan", "plan.json", "--rig", "rig.toml")
    subprocess.run(
        [*STRACE, "-o", trace, sys.executable, "-m", "gonio", *options],
        cwd=work, env=os.environ | {"OMP_NUM_THREADS": "1"}, check=True, capture_output=True,
    )  # fmt: skip
    return work, before, trace.read_text().splitlines()


def start(log):
    work, before, lines = log
    disk = Disk(before)
    disk.root = str(work)
    return disk, lines


def test_the_replay_ends_with_what_is_there(log):
    disk, lines = start(log)
    for line in lines:
        disk.do(line)
    tree = disk.tree("live", "live")["session"]
    for path in (log[0] / "session").rglob("*"):
        if path.is_file() and not path.name.endswith("-shm"):
            node = tree
            for part in path.relative_to(log[0] / "session").parts:
                node = node[part]
            assert node == path.read_bytes(), path
    assert len(tree["raw"]) + len(tree["calibration"]) == FRAMES


# the harshest; what the others ask is mostly asked by it
HARSHEST = "nothing but what was synced"


@pytest.mark.parametrize(
    "variant",
    [pytest.param(each, marks=() if each == HARSHEST else pytest.mark.slow) for each in VARIANTS],
)
def test_what_a_power_cut_leaves_goes_on(forks, log, tmp_path, variant):
    disk, lines = start(log)
    moments = resumed = 0
    for line in lines:
        if disk.do(line) is None:
            continue
        moments += 1
        if moments % STRIDE:
            continue
        folder = tmp_path / str(moments)
        unfold(disk.tree(*VARIANTS[variant]), folder)
        resumed += goes_on(forks, folder)
        shutil.rmtree(folder)
    assert resumed > 10


def goes_on(forks, folder):
    session = Session(folder / "session")
    if not session.root.exists():
        return False  # the capture had not told anybody of a session yet
    kept = vouched(session)
    frames = [*session.raw.glob("*.dng"), *session.calibration.glob("*.dng")]
    # one at most lies there whose row was not written yet
    assert len(frames) - len(kept) <= 1
    ended = forks.run(folder, *resume("session"))
    assert (ended.returncode, ended.stderr) == (0, ""), ended.stderr
    keys = shots_of(session)
    assert len(keys) == len({*keys}) == FRAMES
    assert kept.items() <= vouched(session).items()
    return True
