"""Imperfect cameras and lamps through the command line, to samples and a model."""

import json
from pathlib import Path

import numpy as np
import pytest
import rawpy

from gonio.samples import Samples

HOT = """
camera_dark_e_per_s = 10
camera_hot_share = 0.002
camera_hot_times = 500
camera_sensor_rise_c = 30
"""


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def raw_of(path):
    with rawpy.imread(str(path)) as raw:
        return raw.raw_image.astype(float)


@pytest.fixture
def hot(gonio, tmp_path):
    """Four shots by a camera with hot pixels, which warms up."""
    (tmp_path / "hot.toml").write_text(HOT)
    ok(gonio("plan", "--density", "2", "--no-page"))
    ok(gonio("capture", "--sim", "--imperfections", "hot.toml"))
    return tmp_path / "session"


def test_dark_frames_show_the_sensor_and_that_it_warms_up(hot):
    longest = sorted((hot / "calibration").glob("dark*_e3_*.dng"))
    first, *_, last = (raw_of(path) - 1024 for path in longest)
    glowing = first > 500
    assert 20 < glowing.sum() < 100
    assert (last[glowing] > 400).all()
    assert last.mean() > 1.02 * first.mean() > 10


def test_a_resume_has_the_same_camera_and_no_other(gonio, hot, tmp_path):
    frame = next((hot / "raw").glob("*_e3_*.dng"))
    before = raw_of(frame)
    frame.unlink()
    (tmp_path / "hot.toml").unlink()
    refused = gonio("capture", "--sim", "--resume", "--imperfections", "mild")
    assert refused.returncode == 4
    assert "resume without --imperfections" in refused.stderr
    ok(gonio("capture", "--sim", "--resume"))
    after = raw_of(max((hot / "raw").glob(f"{frame.name[:15]}*")))
    dark = np.s_[:4]
    assert np.corrcoef(before[dark].ravel(), after[dark].ravel())[0, 1] > 0.9


def test_without_the_option_nothing_is_noted(gonio, tmp_path):
    ok(gonio("plan", "--density", "2", "--no-page"))
    ok(gonio("capture", "--sim", "-o", "plain"))
    ok(gonio("capture", "--sim", "--imperfections", "none", "-o", "none"))
    notes, raws = zip(*(seen(tmp_path / name) for name in ("plain", "none")), strict=True)
    assert notes[0] == notes[1] == {"material": "wood-veneer", "seed": 0, "sha256": ""}
    assert raws[0] == raws[1]


def seen(session: Path):
    frames = {path.name: path.read_bytes() for path in (session / "raw").iterdir()}
    return json.loads((session / "sim/twin.json").read_text()), frames


@pytest.mark.slow
def test_a_mildly_imperfect_capture_is_reconstructed(gonio, tmp_path):
    ok(gonio("plan", "--density", "3", "--no-page"))
    for name in ("none", "mild"):
        ok(gonio("capture", "--sim", "--imperfections", name, "-o", name))
    ok(gonio("reduce", "none"))
    ok(gonio("reconstruct", "mild", "--estimator", "paper", "--epochs", "2"))
    ideal, mild = (Samples.load(tmp_path / name / "samples.nc").value for name in ("none", "mild"))
    assert 0.001 < np.median(np.abs(mild / ideal - 1.0)) < 0.02
