"""Where a reconstruction leaves its model and its page: checked before, never of two models."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from gonio.cli import main

NETWORK = ("--estimator", "paper", "--epochs", "2")
DIES = """
import os, signal
import gonio.report
gonio.report.write_report = lambda *_, **__: os.kill(os.getpid(), signal.SIGKILL)
from gonio.cli import main
main()
"""


def write_table(path, count):
    rng = np.random.default_rng(0)
    rows = zip(*rng.uniform(0, 75, (4, count)), *rng.uniform(0.1, 0.2, (3, count)), strict=True)
    lines = ["light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg,r,g,b"]
    path.write_text("\n".join([*lines, *(",".join(map(str, row)) for row in rows)]))


def killed_before_the_page(folder, source):
    """Run a reconstruction that is killed when the model is there and the page is not."""
    done = subprocess.run(
        [sys.executable, "-c", DIES, "reconstruct", source, *NETWORK],
        cwd=folder,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        capture_output=True,
        check=False,
    )
    assert done.returncode == -signal.SIGKILL, done.stderr


@pytest.mark.slow
def test_no_page_of_an_older_model_stays_beside_a_new_one(gonio, tmp_path):
    write_table(tmp_path / "table.csv", 12)
    assert gonio("plan", "--density", "3", "--criterion", "farthest", "--no-page").returncode == 0
    assert gonio("capture", "--sim").returncode == 0
    for source, model, page in (
        ("table.csv", "model/model.json", "model/report.html"),
        ("session", "session/model/model.json", "session/report.html"),
    ):
        assert gonio("reconstruct", source, *NETWORK).returncode == 0
        assert (tmp_path / page).is_file()
        killed_before_the_page(tmp_path, source)
        assert (tmp_path / model).is_file()
        assert not (tmp_path / page).exists()


def in_the_way(folder):
    (folder / "m").write_text("a file")


def a_folder_for_the_page(folder):
    (folder / "m/report.html").mkdir(parents=True)


def full(folder, monkeypatch):
    room = os.statvfs_result((4096, 4096, 1000, 0, 0, 0, 0, 0, 0, 255))
    monkeypatch.setattr(os, "statvfs", lambda _: room)


UNUSABLE = {
    "a file in the way": (lambda folder, _: in_the_way(folder), "Not a directory"),
    "a folder for the page": (lambda folder, _: a_folder_for_the_page(folder), "is a folder"),
    "a full disk": (full, "the disk is full"),
}


@pytest.mark.parametrize("name", UNUSABLE)
def test_an_unusable_place_is_found_before_any_work(name, tmp_path, monkeypatch, capsys):
    make, says = UNUSABLE[name]
    # too few to be trained on, which would be said after the place was found good
    write_table(tmp_path / "table.csv", 3)
    make(tmp_path, monkeypatch)
    words = ["reconstruct", str(tmp_path / "table.csv"), "-o", str(tmp_path / "m")]
    monkeypatch.setattr("sys.argv", ["gonio", *words])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 3
    assert says in capsys.readouterr().err
