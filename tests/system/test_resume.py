"""What a session holds on to: its materials, its samples, its noise, its notes."""

import json
import os
import re
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys

import numpy as np
import pytest

from gonio.directions import paper_directions
from gonio.files import sha256_file
from gonio.materials import MeasuredTable
from gonio.rig import default_rig_text
from gonio.samples import Samples


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.fixture
def session(gonio, tmp_path):
    """Nine shots of a table that lies beside the session."""
    values = np.random.default_rng(0).uniform(0.1, 0.5, (81, 81, 3))
    MeasuredTable.of(values).save(tmp_path / "mine.npz")
    ok(gonio("plan", "--density", "3", "--no-page"))
    ok(gonio("capture", "--sim", "--material", "mine.npz", "--sample", "mine"))
    return tmp_path / "session"


@pytest.fixture
def drop_frames(rewritten):
    def drop(session, condition):
        change = f"DELETE FROM event WHERE kind = 'frame' AND {condition}"
        rewritten(session / "journal.sqlite", change)

    return drop


def test_samples_reduced_on_purpose_are_what_is_reconstructed(gonio, session, drop_frames):
    ok(gonio("reduce", "--patch-mm", "20"))
    wide = sha256_file(session / "samples.nc")
    ok(gonio("reconstruct", "--estimator", "paper", "--epochs", "2"))
    assert sha256_file(session / "samples.nc") == wide
    assert json.loads((session / "model/model.json").read_text())["provenance"]["samples"] == wide
    drop_frames(session, "data LIKE '%\"shot_index\": 8%' AND data LIKE '%shot_000008%'")
    gonio("reconstruct", "--estimator", "paper", "--epochs", "2")
    assert sha256_file(session / "samples.nc") != wide


def test_a_resume_from_another_folder_finds_the_material(gonio, session, tmp_path, drop_frames):
    drop_frames(session, "data LIKE '%shot_000004%'")
    (tmp_path / "elsewhere").mkdir()
    ok(gonio("capture", "--sim", "--resume", "-o", session, cwd=tmp_path / "elsewhere"))


def test_a_material_that_has_changed_is_refused(gonio, session, tmp_path, drop_frames):
    drop_frames(session, "data LIKE '%shot_000004%'")
    MeasuredTable.of(np.full((81, 81, 3), 0.3)).save(tmp_path / "mine.npz")
    refused = gonio("capture", "--sim", "--resume")
    assert refused.returncode == 4
    assert "is not the file it was begun with" in refused.stderr


def test_repeats_taken_after_a_resume_have_noise_of_their_own(gonio, session, drop_frames):
    before = {path.name: sha256_file(path) for path in (session / "calibration").iterdir()}
    drop_frames(session, "(data LIKE '%_r2_%' OR data LIKE '%_r3_%')")
    for name in before:
        if "_r2_" in name or "_r3_" in name:
            (session / "calibration" / name).unlink()
    ok(gonio("capture", "--sim", "--resume"))
    after = {path.name: sha256_file(path) for path in (session / "calibration").iterdir()}
    # lamps that were cold again make other white frames; dark ones are those of one go
    assert {k: v for k, v in after.items() if "dark" in k}.items() <= before.items()
    assert after.keys() == before.keys()
    assert len(set(after.values())) == len(after)


def test_a_frame_of_no_use_is_taken_again(gonio, session, rewritten):
    frame = session / "raw/shot_000002_e0_r0_a1.dng"
    other = session / "raw/shot_000002_e1_r0_a1.dng"
    shutil.copy(other, frame)  # whole, but of another exposure
    with sqlite3.connect(session / "journal.sqlite") as journal:
        rows = journal.execute("SELECT id, data FROM event WHERE kind = 'frame'").fetchall()
        ((number, data),) = [row for row in rows if "shot_000002_e0" in row[1]]
    changed = json.dumps(json.loads(data) | {"sha256": sha256_file(frame)})
    row = (changed, number)
    rewritten(session / "journal.sqlite", "UPDATE event SET data = ? WHERE id = ?", row)
    reduced = gonio("reduce")
    assert len(Samples.load(session / "samples.nc")) == 8
    told = reduced.stderr.partition("take it again with: ")[2]
    assert told == "gonio capture --sim --resume\n"
    ok(gonio(*shlex.split(told)[1:]))
    ok(gonio("reduce"))
    assert len(Samples.load(session / "samples.nc")) == 9


def test_notes_are_kept_and_a_resume_with_others_is_refused(gonio, session):
    refused = gonio("capture", "--sim", "--resume", "--operator", "Ada")
    assert (refused.returncode, "--operator" in refused.stderr) == (4, True)


def test_a_resume_that_has_nothing_to_do_leaves_the_timings(gonio, session):
    before = (session / "timings.json").read_text()
    assert "complete" in ok(gonio("capture", "--sim", "--resume"))
    assert (session / "timings.json").read_text() == before


def test_a_truth_that_cannot_be_read_costs_no_report(gonio, session):
    (session / "sim/truth.npz").write_bytes(b"PK broken")
    printed = gonio("reconstruct", "--estimator", "paper", "--epochs", "2")
    assert printed.returncode == 0
    assert "truth.npz" in printed.stderr
    assert "not known" in printed.stdout


BAD = {
    "too cold": (("capture", "--sim", "--temperature", "-300"), "temperature_c"),
    "no temperature": (("capture", "--sim", "--temperature", "inf"), "temperature_c"),
    "no seed": (("capture", "--sim", "--seed", "-1"), "--seed"),
    "no command": (("nosuch",), "nosuch"),
}


@pytest.mark.parametrize(("command", "says"), BAD.values(), ids=BAD)
def test_one_line(gonio, tmp_path, command, says):
    ran = gonio(*command)
    assert ran.returncode == 2
    assert says in ran.stderr
    assert len(ran.stderr.splitlines()) == 1
    assert not (tmp_path / "session").exists()


def test_a_plan_that_counts_twice_is_refused(gonio, tmp_path):
    from gonio.plan import Shot

    shot = {
        "index": 0, "light_theta_deg": 0, "light_phi_deg": 0, "view_theta_deg": 0,
        "view_phi_deg": 0, "exposures_s": [0.1], "lamps": [{"n": 1, "mA": 700}],
    }  # fmt: skip
    Shot.model_validate(shot)
    with pytest.raises(ValueError, match="one exposure twice"):
        Shot.model_validate(shot | {"exposures_s": [0.1, 0.1]})
    with pytest.raises(ValueError, match="one lamp twice"):
        Shot.model_validate(shot | {"lamps": shot["lamps"] * 2})


def test_a_table_in_another_order_is_refused(gonio, tmp_path):
    values = np.full((81, 81, 3), 0.2)
    np.savez(tmp_path / "turned.npz", values=values, directions=paper_directions()[::-1])
    ran = gonio("capture", "--sim", "--material", "turned.npz")
    assert (ran.returncode, "not the 81 in their order" in ran.stderr) == (2, True)


def test_a_second_plan_that_counts_shots_again_is_refused(gonio, session, tmp_path):
    from gonio.plan import Plan

    first = Plan.load(session / "plans/000.json")
    first.model_copy(update={"parent": first.sha256}).save(session / "plans/001.json")
    for command in (("capture", "--sim", "--resume"), ("reduce",)):
        ran = gonio(*command)
        assert ran.returncode == 4
        assert "001.json: shot 0 is in a plan before it" in ran.stderr


def test_frames_without_their_journal_are_not_overwritten(gonio, session):
    (session / "journal.sqlite").unlink()
    before = {path.name: sha256_file(path) for path in (session / "raw").iterdir()}
    refused = gonio("capture", "--sim", "--resume")
    assert (refused.returncode, "is gone" in refused.stderr) == (4, True)
    assert {path.name: sha256_file(path) for path in (session / "raw").iterdir()} == before


def test_a_pipe_in_the_place_of_a_file_stays_one(gonio, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    ran = gonio("plan", "-o", "pipe")
    assert (ran.returncode, "is no file" in ran.stderr) == (3, True)
    assert (tmp_path / "pipe").is_fifo()


def test_a_plot_does_not_replace_its_plan(gonio, tmp_path):
    ran = gonio("plan", "--plot", "plan.json")
    assert (ran.returncode, len(ran.stderr.splitlines())) == (2, 1)
    assert not (tmp_path / "plan.json").exists()


def test_a_reference_that_is_not_there_costs_no_session(gonio, tmp_path):
    rig = default_rig_text()
    assert "reference = " in rig
    (tmp_path / "rig.toml").write_text(re.sub(r"reference = .*", 'reference = "gone.npz"', rig))
    ran = gonio("capture", "--sim", "--rig", "rig.toml")
    assert ran.returncode == 2
    assert not (tmp_path / "session").exists()


# so many shots that it is not over before the signal; or a capture without a plan
LONG = ("--density", "8", "--criterion", "farthest", "--no-page")
STOPS = {
    "Ctrl-C": (signal.SIGINT, 130, "session", LONG),
    "Ctrl-C without a plan": (signal.SIGINT, 130, "session", None),
    "shutdown": (signal.SIGTERM, 143, "my metal", LONG),
    "closed terminal": (signal.SIGHUP, 143, "session", LONG),
}


def as_in_a_terminal():
    """Undo what a shell's background job or nohup has its children ignore."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


@pytest.mark.parametrize(
    ("number", "code", "root", "plan"),
    [
        # all 196 shots of the plan that it makes itself
        pytest.param(*stop, id=name, marks=() if stop[-1] else pytest.mark.slow)
        for name, stop in STOPS.items()
    ],
)
def test_a_capture_is_stopped_in_order(gonio, tmp_path, number, code, root, plan):
    if plan:
        ok(gonio("plan", *plan))
    process = subprocess.Popen(
        [sys.executable, "-m", "gonio", "capture", "--sim", "-o", root],
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        preexec_fn=as_in_a_terminal,  # noqa: PLW1509 - there are no threads here
    )
    while not list((tmp_path / root / "raw").glob("*.dng")):
        os.sched_yield()
    process.send_signal(number)
    _, said = process.communicate()
    assert process.returncode == code
    told = said.partition("what was finished is kept; go on with: ")[2]
    assert ("-o" in told) == (root != "session")
    assert "frames of" in ok(gonio(*shlex.split(told)[1:]))


def test_values_that_no_reflectance_has_are_refused(gonio, tmp_path):
    names = "light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg,y"
    rows = "\n".join(f"{10 * i},0,0,0,1e300" for i in range(9))
    (tmp_path / "huge.csv").write_text(f"{names}\n{rows}\n")
    ran = gonio("reconstruct", "huge.csv", "-o", "m")
    assert (ran.returncode, len(ran.stderr.splitlines())) == (2, 1)
    assert not (tmp_path / "m").exists()
