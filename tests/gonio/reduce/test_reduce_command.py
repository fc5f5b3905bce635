import csv

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.cli.reduce import command
from gonio.errors import BadInputError
from gonio.reduce.patch import LARGEST_MM
from gonio.samples import Samples
from gonio.tables import read_table
from nnbrdf.analytic import Lambert

from .conftest import SMALL_RIG

TWO = [(20, 0, 40, 90), (50, 10, 30, 200)]


@pytest.fixture
def shots(photographer):
    taken = photographer(TWO, Lambert((0.4, 0.3, 0.2)), exposures_s=(0.2,), rig_text=SMALL_RIG)
    return taken.calibrate().shoot()


def test_the_command_writes_samples_and_says_so(shots, gonio):
    done = gonio("reduce", shots.session.root)
    assert done.returncode == 0, done.stderr
    lines = {" ".join(line.split()) for line in done.stdout.splitlines()}
    assert {"shots planned 2", "samples 2", "clipped 0", "faint 0"} <= lines
    assert f"samples: {shots.session.samples_path}" in lines
    assert len(Samples.load(shots.session.samples_path)) == 2
    assert shots.session.timings()["reduce"] > 0


def test_what_was_left_out_is_said_in_one_line(shots, gonio):
    next(shots.session.raw.iterdir()).unlink()
    done = gonio("reduce", shots.session.root)
    assert done.returncode == 0
    assert done.stderr.count("1 of 2 shots left out") == 1
    assert "samples 1" in {" ".join(line.split()) for line in done.stdout.splitlines()}


def test_a_damaged_session_ends_in_one_line(shots, gonio):
    for frame in shots.session.raw.iterdir():
        frame.write_bytes(b"")
    done = gonio("reduce", shots.session.root)
    assert done.returncode == 2
    assert "none of the 2 shots can be used" in done.stderr
    assert "Traceback" not in done.stderr


def test_the_help_shows_an_example(gonio):
    assert "\n      gonio reduce session/ --patch-mm 20\n" in gonio("reduce", "--help").stdout


def test_no_session(tmp_path, gonio):
    done = gonio("reduce", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "session: no such folder" in done.stderr


def test_the_patch_is_an_option(shots):
    runner = CliRunner()
    root = str(shots.session.root)
    assert runner.invoke(command, [root, "--patch-mm", "20"]).exit_code == 0
    large = Samples.load(shots.session.samples_path)
    assert runner.invoke(command, [root]).exit_code == 0
    standard = Samples.load(shots.session.samples_path)
    assert large.view_solid_angle == pytest.approx(
        (20 / LARGEST_MM) ** 2 * standard.view_solid_angle
    )
    refused = runner.invoke(command, [root, "--patch-mm", "0"])
    assert isinstance(refused.exception, BadInputError)


def test_another_gonio_on_the_session_is_refused(shots):
    with shots.session.lock():
        refused = CliRunner().invoke(command, [str(shots.session.root)])
    assert "another gonio works on this session" in str(refused.exception)


def test_a_table_of_the_brdf_reads_back_as_the_samples(shots, gonio, tmp_path):
    done = gonio("reduce", shots.session.root, "--csv", tmp_path / "f.csv")
    assert done.returncode == 0, done.stderr
    samples, table = Samples.load(shots.session.samples_path), read_table(tmp_path / "f.csv")
    np.testing.assert_array_equal(table.value, samples.value)
    np.testing.assert_array_equal(table.sigma, samples.sigma)
    np.testing.assert_allclose(table.light, samples.light, atol=1e-12)
    np.testing.assert_allclose(table.view, samples.view, atol=1e-12)


def test_a_table_of_the_reflectance_factor_is_pi_times_that_and_taken_for_nothing_else(
    shots, gonio, tmp_path
):
    table = tmp_path / "factors.csv"
    gonio("reduce", shots.session.root, "--csv", table, "--quantity", "reflectance-factor")
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    samples = Samples.load(shots.session.samples_path)
    for index, channel in enumerate("rgb"):
        for prefix, told in (("", samples.value), ("sigma_", samples.sigma)):
            factor = [float(row[f"{prefix}reflectance_factor_{channel}"]) for row in rows]
            np.testing.assert_allclose(factor, np.pi * told[:, index])
    refused = gonio("reconstruct", table, "-o", tmp_path / "model")
    assert refused.returncode == 2
    assert "factors.csv" in refused.stderr


def test_a_quantity_without_a_table_is_refused(shots, gonio):
    refused = gonio("reduce", shots.session.root, "--quantity", "reflectance-factor")
    assert refused.returncode == 2
    assert "name one with --csv FILE" in refused.stderr


OWN = {
    "journal": (("--csv", "journal.sqlite"), "journal.sqlite: is a file of the session"),
    "frame": (("--csv", "raw/shot_000000_0.2_r0_a1.dng"), "a1.dng: is a file of the session"),
    "folder": (("--radiance", "."), "is the session's; name a folder of its own"),
    "raw": (("--radiance", "raw"), "raw: is the session's; name a folder of its own"),
}


@pytest.mark.parametrize(("option", "says"), OWN.values(), ids=OWN)
def test_nothing_is_written_over_the_session(shots, gonio, option, says):
    root = shots.session.root
    done = gonio("reduce", root, option[0], root / option[1])
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert says in done.stderr
    assert gonio("reduce", root, "--csv", root / "table.csv").returncode == 0
    assert gonio("reduce", root, "--csv", root / "table.csv").returncode == 0
