"""`gonio capture --calibration`: what it takes, what it refuses, and what the samples gain."""

import shutil
from datetime import UTC, datetime

import numpy as np
import pytest

from gonio.calibrationfolder import load_calibration
from gonio.directions import normalize
from gonio.reduce.btf import Btf
from gonio.samples import Samples
from gonio.session import Session
from sim.materials import load_material


@pytest.fixture
def folder(bench, tmp_path):
    """A copy of the bench, to change at will."""
    return shutil.copytree(bench, tmp_path / "bench")


@pytest.fixture
def capture(gonio, folder):
    """Capture with the bench's rig, plan and twin: capture("--calibration", "calibration")."""

    def run(*options, imperfections="worse.toml"):
        return gonio(
            "capture", "--sim", "--rig", "rig.toml", "--material", "matte-paint",
            "--imperfections", imperfections, *options, cwd=folder,
        )  # fmt: skip

    return run


def errors(folder, session):
    samples = Samples.load(folder / session / "samples.nc")
    truth = load_material("matte-paint").evaluate(samples.light, samples.view)
    return np.abs(samples.value / truth - 1.0)


def texel_errors(gonio, folder, session):
    """Relative errors of the texels in the middle of each picture."""
    done = gonio("reduce", session, "--btf", "--texels", "14", cwd=folder)
    assert done.returncode == 0, done.stderr
    group = Btf.open(Session(folder / session)).group
    light, view = np.argwhere(np.isfinite(group["light_mm"][...]).all(axis=-1)).T
    found = group["value"][...][light, view, 4:10, 4:10]
    truth = load_material("matte-paint").evaluate(
        *(normalize(group[f"{side}_mm"][...][light, view]) for side in ("light", "view"))
    )
    return found / truth[:, None, None] - 1.0


def test_samples_and_texels_come_nearer_to_the_truth(gonio, folder, capture):
    for session, options in {"raw": (), "corrected": ("--calibration", "calibration")}.items():
        done = capture("-o", session, *options)
        assert done.returncode == 0, done.stderr
        assert gonio("reduce", session, "--patch-mm", "30", cwd=folder).returncode == 0
    raw, corrected = (errors(folder, session) for session in ("raw", "corrected"))
    assert np.median(corrected) < 0.5 * np.median(raw)
    assert np.median(corrected) < 0.003
    raw, corrected = (texel_errors(gonio, folder, session) for session in ("raw", "corrected"))
    # each texel has its own noise; neighbors' errors that go together are what is corrected
    assert np.nanmedian(np.abs(corrected)) < 0.7 * np.nanmedian(np.abs(raw))
    document = load_calibration(folder / "calibration")
    provenance = Samples.load(folder / "corrected/samples.nc").provenance
    assert provenance["calibration"] == document.sha256
    assert "calibration" not in Samples.load(folder / "raw/samples.nc").provenance
    parts = {
        session: Samples.load(folder / session / "samples.nc").components["calibration"]
        for session in ("raw", "corrected")
    }
    assert not parts["raw"].any()
    assert (parts["corrected"] > 0).all()


def test_light_pixel_by_pixel(gonio, folder, capture):
    assert capture("--calibration", "calibration").returncode == 0
    done = gonio("reduce", "session", "--radiance", "light", cwd=folder)
    assert done.returncode == 0, done.stderr
    files = sorted((folder / "light").glob("shot_*.npz"))
    assert len(files) == 4
    with np.load(files[0]) as shot, np.load(folder / "calibration/maps.npz") as maps:
        light, good = shot["radiance"], ~maps["bad"] & ~shot["clipped"]
        assert np.isnan(light[maps["bad"]]).all()
        # the paint is even: green pixels differ by their noise and little else
        green = np.zeros(light.shape, np.bool_)
        green[20:60:2, 21:60:2] = True
        values = light[green & good]
        sigma = np.sqrt(shot["variance"][green & good])
    assert values.std() / values.mean() < 0.01
    assert np.median(sigma / values) < 0.01


def test_a_copy_that_changed_in_the_session_is_refused(gonio, folder, capture):
    assert capture("--calibration", "calibration").returncode == 0
    maps = folder / "session/calibration/sensor/maps.npz"
    maps.write_bytes(maps.read_bytes()[:-1])
    done = gonio("reduce", "session", cwd=folder)
    assert done.returncode == 4
    assert "maps.npz: has changed since the capture began" in done.stderr


def _old(folder):
    document = load_calibration(folder / "calibration")
    date = datetime(1999, 11, 1, tzinfo=UTC)
    document.model_copy(update={"made_utc": date}).save(folder / "calibration")


def _of_tomorrow(folder):
    document = load_calibration(folder / "calibration")
    date = datetime(2050, 11, 1, tzinfo=UTC)
    document.model_copy(update={"made_utc": date}).save(folder / "calibration")


def _of_another_rig(folder):
    document = load_calibration(folder / "calibration")
    other = document.model_copy(update={"rig_sha256": "0" * 64})
    other.save(folder / "calibration")


def _append(name):
    def change(folder):
        path = folder / "calibration" / name
        path.write_bytes(path.read_bytes() + b" ")

    return change


def _edited(folder):
    path = folder / "calibration/calibration.json"
    path.write_text(path.read_text().replace('"width": 80', '"width": 81'))


REFUSED = {
    "stale": (_old, {}, "days old, and 30 are allowed"),
    "of tomorrow": (_of_tomorrow, {}, "days after now; set the clock right"),
    "another rig": (_of_another_rig, {}, "was made on another rig"),
    "another camera": (lambda _: None, {"imperfections": "mild"}, "was made with another camera"),
    "changed maps": (_append("maps.npz"), {}, "maps.npz: has changed since the calibration"),
    "changed frame": (_append("frames/0000_dark.dng"), {}, "has changed since the calibration"),
    "edited": (_edited, {}, "has changed since it was written"),
    "missing": (lambda folder: shutil.rmtree(folder / "calibration"), {}, "no such file"),
}


@pytest.mark.parametrize(("change", "options", "says"), REFUSED.values(), ids=REFUSED)
def test_one_that_does_not_fit_is_refused_in_one_line(folder, capture, change, options, says):
    change(folder)
    done = capture("--calibration", "calibration", **options)
    assert done.returncode == 2
    assert says in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (folder / "session").exists()


def test_an_old_one_may_be_allowed(folder, capture):
    _old(folder)
    done = capture("--calibration", "calibration", "--max-age", "100")
    assert done.returncode == 0, done.stderr


def test_options_that_go_together(gonio, folder, capture):
    done = capture("--calibration", "calibration", "--max-age", "nan")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    done = capture("--max-age", "3")
    assert done.returncode == 2
    assert "--max-age goes with --calibration" in done.stderr
    done = capture("--calibration", "calibration", "--resume")
    assert done.returncode == 4
    assert "a session keeps the one that it was begun with" in done.stderr


def test_frames_of_another_camera_are_refused(gonio, folder, capture):
    _of_iso_200(folder)
    done = capture("--calibration", "calibration")
    assert done.returncode == 2
    assert "iso 200, and the frames have 100" in done.stderr
    assert "set the camera as it was then, and go on with: gonio capture" in done.stderr
    # a night is not spent on shots of no use, and a resume looks at the camera anew
    assert not list((folder / "session/raw").iterdir())
    before = {path.name for path in (folder / "session/calibration").glob("*.dng")}
    done = capture("--resume")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "iso 200, and the frames have 100" in done.stderr
    after = {path.name for path in (folder / "session/calibration").glob("*.dng")}
    assert len(after) == 2 * len(before)
    done = gonio("reduce", "session", cwd=folder)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    with Session(folder / "session").journal() as journal:
        ends = [event.data["reason"] for event in journal.events("stopped")]
    assert len(ends) == 2
    assert all("another camera or setting" in end for end in ends)


def _of_iso_200(folder):
    document = load_calibration(folder / "calibration")
    camera = document.camera.model_copy(update={"iso": 200})
    document.model_copy(update={"camera": camera}).save(folder / "calibration")
