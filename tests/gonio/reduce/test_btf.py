import os
import shutil
import signal
import subprocess
import sys
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from gonio.camera import Camera
from gonio.cli.reduce import command
from gonio.errors import BadInputError
from gonio.geometry import ArmPose
from gonio.photogrammetry import rectification
from gonio.photogrammetry.grid import TexelGrid
from gonio.photogrammetry.rectification import Rectifier
from gonio.reduce.btf import Btf, cluster
from gonio.reduce.btf.develop import Development, Tiles, develop
from gonio.reduce.hdr import Exposed, Pixels, merge_pixels
from gonio.reduce.merge import merge
from gonio.reduce.reading import Reading
from gonio.rig import default_rig
from gonio.session import Session
from nnbrdf.analytic import Lambert

from .conftest import SMALL_RIG, Photographer, make_plan

PAIRS = [(20, 0, 40, 90), (20, 0, 0, 0), (50, 10, 40, 90), (65, 300, 30, 200)]
LIGHTS, VIEWS = [(20, 0), (50, 10), (65, 300)], [(0, 0), (30, 200), (40, 90)]
ALBEDO = np.array([0.4, 0.3, 0.2])
INSIDE = np.s_[4:-4, 4:-4]
# the sensor sees the sample's middle 20 mm alone
TEXELS = 140
REDUCE = [sys.executable, "-m", "gonio", "reduce", "--btf", "--texels", str(TEXELS)]
SEEN = np.s_[60:80, 60:80]
ONE_CORE = "import os, runpy; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))}); \
runpy.run_module('gonio', run_name='__main__')"
"""So that blocks are done one by one."""


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A session of four shots, two of one light; the tests leave it as it is."""
    plan = make_plan(PAIRS, (0.02, 0.2))
    root = tmp_path_factory.mktemp("btf") / "session"
    taken = Photographer(root, plan, Lambert(tuple(ALBEDO)), rig_text=SMALL_RIG)
    taken.calibrate().shoot().journal.close()
    return root


@pytest.fixture(scope="module")
def reduced(root):
    """What the command says of it, done by local processes."""
    done = subprocess.run([*REDUCE, root], capture_output=True, text=True, check=True)
    return done.stdout


@contextmanager
def dask_workers(count):
    """Run a scheduler and workers; yields its address, their processes, and its own."""
    dask = [sys.executable, "-m", "dask"]
    with ExitStack() as stack:
        scheduler = stack.enter_context(
            _served([*dask, "scheduler", "--port", "0", "--no-dashboard"])
        )
        address = _said(scheduler, "Scheduler at:").split()[-1]
        options = ["--nthreads", "1", "--no-nanny", "--no-dashboard"]
        workers = [
            stack.enter_context(_served([*dask, "worker", address, *options])) for _ in range(count)
        ]
        for worker in workers:
            _said(worker, "Registered to:")
        yield address, workers, scheduler


@contextmanager
def _served(command):
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


def _said(process, what):
    return next(line for line in process.stderr if what in line)


def picture(btf, light, view, name="value"):
    return btf.group[name][LIGHTS.index(light), VIEWS.index(view)].astype(np.float64)


def test_local_processes_give_each_pair_its_picture(root, reduced):
    assert f"3 lights x 3 views, {TEXELS} x {TEXELS} texels" in reduced
    btf = Btf.open(Session(root))
    pulls = []
    for pair in PAIRS:
        value, sigma = (picture(btf, pair[:2], pair[2:], name)[SEEN] for name in ("value", "sigma"))
        assert value.mean(axis=(0, 1)) == pytest.approx(ALBEDO / np.pi, rel=0.02)
        pulls.append((value - ALBEDO / np.pi) / sigma)
    assert 0.7 < np.std(pulls) < 1.2
    measured = np.isfinite(btf.group["value"][...]).any(axis=(2, 3, 4))
    assert measured.sum() == len(PAIRS)
    assert np.array_equal(measured, np.isfinite(btf.group["light_mm"][...]).all(axis=-1))
    view = btf.group["view_mm"][0, VIEWS.index((40, 90))]
    assert view / np.linalg.norm(view) == pytest.approx(btf.group["view"][2], abs=1e-3)


@pytest.mark.usefixtures("reduced")
def test_it_is_read_through_dask(root):
    values = Btf.open(Session(root)).dask()
    assert values.chunksize == (1, 1, 64, 64, 3)
    assert np.isfinite(values[0, 0].compute()).any()
    assert values[:, :, 70, 70].compute().shape == (3, 3, 3)


@pytest.mark.usefixtures("reduced")
def test_a_cluster_whose_worker_is_killed_midway_gives_the_same(root, tmp_path):
    alone = {name: Btf.open(Session(root)).group[name][...] for name in ("value", "sigma")}
    frame = sorted((root / "raw").iterdir())[-2]
    kept = frame.rename(tmp_path / frame.name)
    # whoever opens it waits here, in the middle of a block
    os.mkfifo(frame)
    with (
        dask_workers(2) as (address, workers, _),
        subprocess.Popen([*REDUCE, "--scheduler", address, root]) as reducing,
    ):
        with frame.open("wb"):
            (victim,) = [worker for worker in workers if has_open(worker.pid, frame)]
            kept.replace(frame)
            victim.send_signal(signal.SIGKILL)
            victim.wait()
        assert reducing.wait(timeout=60) == 0
    for name, values in alone.items():
        assert np.array_equal(Btf.open(Session(root)).group[name][...], values, equal_nan=True)


@pytest.mark.slow
@pytest.mark.parametrize("who", ["all workers of the scheduler are", "the scheduler is"])
def test_a_cluster_that_is_gone_is_not_waited_for(root, tmp_path, who):
    shutil.copytree(root, tmp_path / "session")
    frame = sorted((tmp_path / "session/raw").iterdir())[-2]
    kept = frame.rename(tmp_path / frame.name)
    os.mkfifo(frame)
    command = [*REDUCE, "--anew", "--scheduler"]
    with (
        dask_workers(1) as (address, (worker,), scheduler),
        subprocess.Popen(
            [*command, address, tmp_path / "session"], stderr=subprocess.PIPE, text=True
        ) as reducing,
    ):
        with frame.open("wb"):
            kept.replace(frame)
            (worker if "workers" in who else scheduler).kill()
        try:
            told = reducing.communicate(timeout=120)[1]
        finally:
            reducing.kill()
        assert reducing.returncode == 2, told
        assert f"{who} gone" in told
        assert "Traceback" not in told


@pytest.mark.usefixtures("reduced")
def test_what_was_killed_goes_on_where_it_was(root, gonio, tmp_path):
    killed = Path(shutil.copytree(root, tmp_path / "session"))
    alone = {name: Btf.open(Session(root)).group[name][...] for name in ("value", "sigma")}
    shutil.rmtree(killed / "btf.zarr")
    frame = sorted((killed / "raw").iterdir())[-2]
    kept = frame.rename(tmp_path / frame.name)
    os.mkfifo(frame)
    command = [sys.executable, "-c", ONE_CORE, "reduce", "--btf", "--texels", str(TEXELS), killed]
    # the last of three blocks waits here for its frame, when the others are done
    with (
        subprocess.Popen(command, start_new_session=True) as reducing,
        frame.open("wb"),
    ):
        os.killpg(reducing.pid, signal.SIGKILL)
    kept.replace(frame)

    refused = gonio("reduce", "--btf", "--texels", 20, killed)
    assert refused.returncode == 4
    assert "had other pairs, texels" in refused.stderr
    resumed = gonio("reduce", "--btf", "--texels", TEXELS, killed)
    assert resumed.returncode == 0, resumed.stderr
    assert "going on with a reduction that was interrupted" in resumed.stderr
    found = Btf.open(Session(killed))
    for name, values in alone.items():
        assert np.array_equal(found.group[name][...], values, equal_nan=True)
    assert not (killed / "btf.zarr" / "done").exists()


def has_open(pid, path):
    handles = Path(f"/proc/{pid}/fd").iterdir()
    return str(path) in {str(handle.readlink()) for handle in handles if handle.is_symlink()}


def test_what_was_left_out_is_said_and_empty(root, gonio, tmp_path):
    damaged = Path(shutil.copytree(root, tmp_path / "session"))
    next((damaged / "raw").glob("shot_000003*")).write_bytes(b"")
    done = gonio("reduce", "--btf", "--texels", 20, damaged)
    assert done.returncode == 0
    assert done.stderr.count("1 of 4 shots left out") == 1
    assert np.isnan(picture(Btf.open(Session(damaged)), (65, 300), (30, 200))).all()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--texels", "20"], "options of --btf"),
        (["--btf", "--texels", "0"], "0 texels a side"),
        (["--btf", "--scheduler", "nowhere:1"], "no Dask scheduler answers at nowhere:1"),
    ],
)
def test_what_makes_no_sense_ends_in_one_line(root, options, said, monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.5)
    refused = CliRunner().invoke(command, [str(root), *options])
    assert said in f"{refused.exception} {refused.output}"
    assert isinstance(refused.exception, BadInputError | SystemExit)


@given(
    theta=st.floats(0, 80),
    phi=st.floats(0, 360),
    pattern=st.sampled_from(["RGGB", "BGGR", "GRBG", "GBRG"]),
    distortion=st.sampled_from([(), (0.3, 0.0, 0.01, -0.01, 0.0)]),
)
def test_a_ramp_is_rectified_to_where_the_texels_are_seen(theta, phi, pattern, distortion):
    spec = default_rig().camera.model_copy(update={"distortion": distortion})
    grid, pose = TexelGrid(14), ArmPose.from_degrees(theta, phi)
    rows, columns = np.indices((spec.height, spec.width), np.float32)
    x, y = np.meshgrid(grid.x_mm, -grid.x_mm)
    points = np.stack([x, y, np.zeros_like(x)], axis=-1)
    pixels = Camera(spec).project(points, pose).reshape(14, 14, 2)
    for axis, ramp in enumerate((columns, rows)):
        texels = Rectifier(ramp, np.ones_like(ramp), pattern, Camera(spec), pose, grid)
        value, _ = texels.rows(0, 14)
        # a texel is a sum of pixels about its middle, which perspective puts off it
        assert np.abs(value - pixels[..., axis])[:, *INSIDE].max() < 0.15


def test_the_variance_is_that_of_the_interpolated_noise():
    spec, grid = default_rig().camera, TexelGrid(140)
    noise = np.random.default_rng(0).standard_normal((160, 160)).astype(np.float32)
    pose = ArmPose.from_degrees(30, 77)
    rectifier = Rectifier(noise, np.ones_like(noise), "RGGB", Camera(spec), pose, grid)
    value, variance = rectifier.rows(0, 140)
    inside = np.s_[:, 8:-8, 8:-8]
    spread = value[inside].std(axis=(1, 2))
    assert spread == pytest.approx(np.sqrt(variance[inside].mean(axis=(1, 2))), rel=0.05)


GAIN, READ, BLACK, SATURATION = 1.1, 12.0, 1000, 60000


@given(st.lists(st.integers(0, 50000), min_size=3, max_size=3))
def test_pixels_are_merged_as_patches_are(signals):
    exposures = (0.5, 5.0, 40.0)
    frames = [
        Exposed(np.array([[BLACK + s]], np.uint16), np.full((1, 1), BLACK, np.float32), e, READ)
        for s, e in zip(signals, exposures, strict=True)
    ]
    readings = [
        Reading(
            signal=np.full(3, float(s)), exposure=np.full(3, e), pixels=np.ones(3, np.intp),
            saturated=np.zeros(3, bool), read_variance=READ, light=np.zeros(3), view=np.zeros(3),
            light_solid_angle=0.0, view_solid_angle=0.0, dark_variance=0.0, surround=np.zeros(3),
            stray=np.zeros(3), arms_rad=np.zeros(4),
        )
        for s, e in zip(signals, exposures, strict=True)
    ]  # fmt: skip
    merged, expected = merge_pixels(frames, Pixels(GAIN, SATURATION)), merge(readings, GAIN)
    assert merged.value[0, 0] == pytest.approx(expected.value[0], rel=1e-5)
    assert merged.variance[0, 0] == pytest.approx(expected.variance[0], rel=1e-5)


def test_saturated_pixels_count_in_no_exposure_and_all_saturated_is_a_lower_bound():
    dark = np.full((1, 2), BLACK, np.float32)
    short = Exposed(np.array([[BLACK + 500, 65000]], np.uint16), dark, 1.0, READ)
    long = Exposed(np.array([[65000, 65000]], np.uint16), dark, 10.0, READ)
    merged = merge_pixels([long, short], Pixels(GAIN, SATURATION))
    assert merged.value[0].tolist() == [500, 64000]
    assert merged.clipped[0].tolist() == [False, True]


@pytest.mark.parametrize("side", [0, -1, 20000])
def test_grids_that_nobody_can_mean_are_refused(side):
    with pytest.raises(BadInputError, match="texels a side"):
        TexelGrid(side)


@pytest.mark.skipif(rectification._pixels is None, reason="the kernel was not compiled")
def test_the_kernel_develops_as_numpy_does(monkeypatch):
    spec, grid, random = default_rig().camera, TexelGrid(70), np.random.default_rng(0)
    value, noise = random.random((2, 160, 160)).astype(np.float32)
    noise[random.random(noise.shape) < 0.01] = np.inf
    by = Development(
        np.array([1.0, 2.0, 0.5]), np.full(3, 1e-3), np.eye(3) + 0.1,
        random.random((70, 70)).astype(np.float32),
    )  # fmt: skip
    made = []
    for kernel in (rectification._pixels, None):
        monkeypatch.setattr(rectification, "_pixels", kernel)
        made.append(Tiles.empty(70, 64))
        pose = ArmPose.from_degrees(30, 77)
        develop(Rectifier(value, noise, "RGGB", Camera(spec), pose, grid), by, made[-1])
    assert made[0].value == pytest.approx(made[1].value, rel=1e-3, abs=1e-4, nan_ok=True)
    assert np.allclose(made[0].sigma, made[1].sigma, rtol=2e-3, equal_nan=True)
    assert np.isinf(made[0].sigma).any()
