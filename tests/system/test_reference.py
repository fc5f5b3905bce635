"""A white reference given by a table: the session keeps its own copy, and uses no other."""

import json

import numpy as np
import pytest

from gonio.files import sha256_file
from gonio.materials import MeasuredTable
from gonio.rig import default_rig_text
from gonio.samples import Samples


def white_table(factor):
    return MeasuredTable.of(np.full((81, 81, 3), factor / np.pi))


@pytest.fixture
def captured(gonio, tmp_path):
    """Capture four shots with a table as the white reference."""
    rig = default_rig_text().replace("reference = 0.99", 'reference = "white.npz"')
    assert rig != default_rig_text()
    (tmp_path / "rig.toml").write_text(rig)
    white_table(0.9).save(tmp_path / "white.npz")
    plan = ("--density", "2", "--criterion", "farthest", "--no-page")
    assert gonio("plan", *plan, "--rig", "rig.toml").returncode == 0
    ran = gonio("capture", "--sim", "--rig", "rig.toml")
    assert ran.returncode == 0, ran.stderr
    return tmp_path / "session"


def test_a_black_reference_is_refused_before_anything_moves(gonio, tmp_path):
    rig = default_rig_text().replace("reference = 0.99", 'reference = "black.npz"')
    (tmp_path / "rig.toml").write_text(rig)
    black = np.zeros((81, 81, 3))
    black[0, 0] = 1.0
    MeasuredTable(black, 1.0).save(tmp_path / "black.npz")
    assert gonio("plan", "--shots", "1", "--rig", "rig.toml", "--no-page").returncode == 0
    ran = gonio("capture", "--sim", "--rig", "rig.toml")
    assert (ran.returncode, ran.stderr.count("\n")) == (2, 1)
    assert "black.npz: is black where the white frames are taken from" in ran.stderr
    assert not (tmp_path / "session").exists()


def test_the_session_keeps_and_reads_its_own_copy(gonio, captured, tmp_path):
    copy = captured / "calibration/reference.npz"
    noted = json.loads(copy.with_suffix(".json").read_text())
    assert noted == {"named": "white.npz", "sha256": sha256_file(copy)}
    assert gonio("reduce", "session").returncode == 0
    before = Samples.load(captured / "samples.nc")
    assert before.provenance["reference"] == noted["sha256"]
    white_table(0.45).save(tmp_path / "white.npz")
    assert gonio("reduce", "session").returncode == 0
    np.testing.assert_array_equal(Samples.load(captured / "samples.nc").value, before.value)
    (tmp_path / "white.npz").unlink()
    next((captured / "raw").iterdir()).unlink()
    ran = gonio("capture", "--sim", "--resume")
    assert ran.returncode == 0, ran.stderr
