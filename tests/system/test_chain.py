"""The three commands as one chain, through the command line."""

import csv
import json
import re
import shutil
import sqlite3

import numpy as np
import pytest

from gonio.files import sha256_file
from gonio.samples import Samples

MODEL_FILES = ("weights.safetensors", "model.json", "grid.npz")


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def hashes(folder):
    return {name: sha256_file(folder / name) for name in MODEL_FILES}


def run_chain(gonio, *choice):
    ok(gonio("plan", "--density", "4", *choice))
    ok(gonio("capture", "--sim", "--material", "wood-veneer"))
    return ok(gonio("reconstruct", "session/", "--estimator", "paper", "--epochs", 20))


def test_the_chain_leaves_what_it_promises(gonio, tmp_path):
    printed = run_chain(gonio)
    session = tmp_path / "session"
    assert "eps8" in printed
    assert "male" in printed
    plan = json.loads((session / "plans/000.json").read_text())
    assert len(plan["shots"]) == 16
    assert len(list((session / "raw").iterdir())) == 16 * 4
    samples = Samples.load(session / "samples.nc")
    assert samples.value.shape == (16, 3)
    assert np.isfinite(samples.sigma).all()
    with np.load(session / "model/grid.npz", allow_pickle=False) as grid:
        assert {name: grid[name].shape for name in grid} == dict.fromkeys(
            ("values", "sigma", "lo", "hi"), (81, 81, 3)
        )
    page = (session / "report.html").read_text()
    assert "<html" in page
    assert "http://" not in page.replace("http://www.w3.org", "")


def test_a_capture_says_how_well_its_time_was_foretold_and_the_report_repeats_it(gonio, tmp_path):
    ok(gonio("plan", "--density", "4", "--criterion", "farthest", "--no-page"))
    said = ok(gonio("capture", "--sim", "--seed", "3"))
    told = next(line for line in said.splitlines() if line.startswith("that is "))
    sentence = told.removeprefix("that is ")
    assert "than estimated, within the 5 to 95 % interval, and " in sentence
    assert sentence.endswith(" once home")
    assert float(re.findall(r"([\d.]+)%", sentence)[1]) < 1.0
    ok(gonio("reconstruct", "session/", "--estimator", "paper", "--epochs", "2"))
    assert sentence in (tmp_path / "session/report.html").read_text()


def test_the_model_does_not_know_the_truth(gonio, tmp_path):
    run_chain(gonio, "--no-page")
    session = tmp_path / "session"
    before = hashes(session / "model")
    shutil.rmtree(session / "sim")
    shutil.rmtree(session / "model")
    (session / "samples.nc").unlink()
    printed = ok(gonio("reconstruct", "session/", "--estimator", "paper", "--epochs", 20))
    assert hashes(session / "model") == before
    assert "not known" in printed


def test_two_runs_of_one_seed_are_equal_to_the_bit(gonio, gonio_from_nothing, tmp_path):
    # the two hash strings differently, on which nothing may depend
    for run, name in ((gonio, "a"), (gonio_from_nothing, "b")):
        ok(run("capture", "--sim", "--plan", plan_of(run, tmp_path), "-o", name))
    frames = [
        {path.name: sha256_file(path) for path in sorted((tmp_path / name).rglob("*.dng"))}
        for name in ("a", "b")
    ]
    assert frames[0] == frames[1]
    assert len(frames[0]) == 4 * 4 + 32


def plan_of(gonio, folder):
    path = folder / "plan2.json"
    ok(gonio("plan", "--density", "2", "--no-page", "-o", path))
    return path


@pytest.mark.slow
def test_a_table_goes_the_same_way(gonio, tmp_path):
    run_chain(gonio, "--no-page")
    samples = Samples.load(tmp_path / "session/samples.nc")
    table = tmp_path / "samples.csv"
    write_table(table, samples)
    printed = ok(
        gonio("reconstruct", "samples.csv", "-o", "model/", "--estimator", "paper", "--epochs", 20)
    )
    assert "eps8" in printed
    with (
        np.load(tmp_path / "model/grid.npz") as ours,
        np.load(tmp_path / "session/model/grid.npz") as theirs,
    ):
        # the table keeps twelve digits, so the trainings start from all but equal targets
        assert np.median(np.abs(ours["values"] - theirs["values"])) < 0.02 * samples.white


def write_table(path, samples):
    from gonio.directions import to_degrees

    angles = np.stack([*to_degrees(samples.light), *to_degrees(samples.view)], axis=1)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        names = "light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg,r,g,b"
        writer.writerow([*names.split(","), "sigma_r", "sigma_g", "sigma_b"])
        for angle, value, sigma in zip(angles, samples.value, samples.sigma, strict=True):
            writer.writerow([f"{number:.12g}" for number in (*angle, *value, *sigma)])


def test_a_killed_capture_goes_on_where_it_was(gonio, tmp_path, rewritten):
    plan = plan_of(gonio, tmp_path)
    ok(gonio("capture", "--sim", "--plan", plan, "-o", "whole"))
    ok(gonio("capture", "--sim", "--plan", plan, "-o", "broken"))
    broken = tmp_path / "broken"
    forget_after(broken, 37, rewritten)
    (broken / "raw/shot_000000_e0_r0_a1.dng").write_bytes(b"half a fr")
    ok(gonio("capture", "--sim", "--resume", "-o", "broken"))
    assert newest(broken).keys() == newest(tmp_path / "whole").keys()
    for key, (name, digest) in newest(broken).items():
        assert sha256_file(broken / name) == digest, key
    again = gonio("capture", "--sim", "--resume", "-o", "broken")
    assert "complete" in ok(again)


def forget_after(session, frames, rewritten):
    """Leave the session as a kill -9 right after that many frames would: a file without a row."""
    with sqlite3.connect(session / "journal.sqlite") as journal:
        rows = journal.execute("SELECT id FROM event WHERE kind = 'frame' ORDER BY id").fetchall()
    rewritten(session / "journal.sqlite", "DELETE FROM event WHERE id > ?", rows[frames - 1])


def newest(session):
    """Return file and hash of the newest record of each frame."""
    with sqlite3.connect(session / "journal.sqlite") as journal:
        rows = journal.execute("SELECT data FROM event WHERE kind = 'frame' ORDER BY id").fetchall()
    frames = [json.loads(data) for (data,) in rows]
    return {
        (frame["role"], frame["shot_index"], frame["repeat"], frame["exposure_s"]): (
            frame["file"],
            frame["sha256"],
        )
        for frame in frames
    }


@pytest.mark.measured
def test_a_measured_material_through_the_noisy_twin(gonio, tmp_path, measured):
    material = measured / "rgl_satin_rosaline.npz"
    ok(gonio("plan", "--density", "6", "--no-page"))
    ok(gonio("capture", "--sim", "--material", material))
    ok(gonio("reduce", "session/"))
    samples = Samples.load(tmp_path / "session/samples.nc")
    from gonio.materials import MeasuredTable

    true = MeasuredTable.load(material).evaluate(samples.light, samples.view)
    unclipped = samples.flag & 1 == 0
    error = np.abs(samples.value - true)[unclipped] / true[unclipped]
    assert np.median(error) < 0.01
