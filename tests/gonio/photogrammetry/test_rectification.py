"""Pictures on the sample's plane."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.alignment import Alignment
from gonio.camera import Camera
from gonio.photogrammetry import rectification
from gonio.photogrammetry.footprint import means_of_rows
from gonio.photogrammetry.grid import TexelGrid
from gonio.photogrammetry.rectification import Rectifier
from gonio.rig import default_rig

# sees the whole sample at any azimuth
SPEC = default_rig().camera.model_copy(
    update={"width": 240, "height": 240, "centre_px": (119.5, 119.5)}
)
LENS = SPEC.model_copy(update={"focal_px": 3000.0, "distortion": (-2.0, 0.5, 0.01, -0.02, 0.0)})
ALIGNMENT = Alignment(theta_offset_deg=0.3, roll_deg=2.0, centre_x_mm=0.5, distance_mm=3.0)

CAMERA = st.sampled_from([Camera(SPEC), Camera(LENS)])
POSE = st.builds(ALIGNMENT.pose, st.floats(0.0, 80.0), st.floats(0.0, 360.0))
TEXELS = st.integers(1, 90)
few = settings(max_examples=15)


@given(CAMERA, POSE)
@few
def test_the_grid_is_projected_as_its_points_are(camera, pose):
    x, y = np.linspace(-40.0, 40.0, 7), np.linspace(30.0, -30.0, 5)
    points = np.stack([*np.meshgrid(x, y), np.zeros((5, 7))], axis=-1)
    seen = np.stack(camera.plane_pixels(x, y, pose), axis=-1)
    np.testing.assert_allclose(seen.reshape(-1, 2), camera.project(points, pose), atol=1e-6)


def flat_picture(level=1.0):
    return np.full((SPEC.height, SPEC.width), level, np.float32)


def texels_of(value, camera, pose, grid, variance=None, pattern="RGGB"):
    noise = np.ones_like(value) if variance is None else variance
    return Rectifier(value, noise, pattern, camera, pose, grid).rows(0, grid.side)


@given(CAMERA, POSE, TEXELS, st.floats(0.1, 1e4))
@few
def test_a_constant_stays_what_it_is(camera, pose, texels, level):
    flat = texels_of(flat_picture(level), camera, pose, TexelGrid(texels))
    np.testing.assert_allclose(flat.value[np.isfinite(flat.value)], level, rtol=1e-5)


@given(CAMERA, POSE, st.integers(15, 90))
@few
def test_a_pattern_on_the_plane_comes_back(camera, pose, texels):
    def pattern(x, y):
        return 2.0 + np.sin(x / 15.0) + np.cos(y / 20.0 + 0.3)

    points = camera.plane_points(pose)
    picture = np.nan_to_num(pattern(points[..., 0], points[..., 1])).astype(np.float32)
    grid = TexelGrid(texels, side_mm=60.0)
    flat = texels_of(picture, camera, pose, grid)
    wanted = np.broadcast_to(pattern(grid.x_mm, -grid.x_mm[:, None]), flat.value.shape)
    np.testing.assert_allclose(flat.value, wanted, atol=0.08)


@given(CAMERA, POSE, st.integers(6, 16))
@few
def test_large_texels_are_means_over_all_that_they_cover(camera, pose, texels):
    """A board finer than texels: a look at the middle alone would be black or white."""
    rows, columns = np.indices((SPEC.height, SPEC.width)) // 2
    picture = np.asarray((rows + columns) % 2, np.float32)
    flat = texels_of(picture, camera, pose, TexelGrid(texels))
    size = min(2.0 * SPEC.focal_px / 4000.0 * 70.0 / texels * np.cos(pose.theta), 4.0)
    assert np.abs(flat.value - 0.5).max() < 0.5 / max(size - 1.0, 1.0) + 0.1


@given(CAMERA, POSE, TEXELS)
@few
def test_pixels_to_leave_out_do_not_count(camera, pose, texels):
    picture = flat_picture()
    away = np.random.default_rng(0).random(picture.shape) < 0.05
    picture[away] = np.nan
    noise = np.where(away, np.float32(np.nan), np.float32(1.0))
    flat = texels_of(picture, camera, pose, TexelGrid(texels), noise)
    np.testing.assert_allclose(flat.value[np.isfinite(flat.value)], 1.0, rtol=1e-5)
    assert np.isfinite(flat.value).mean() > 0.5


@pytest.mark.skipif(rectification._pixels is None, reason="the kernel was not compiled")
@given(CAMERA, POSE, TEXELS, st.sampled_from(["RGGB", "BGGR", "GRBG", "GBRG"]))
@few
def test_the_kernel_says_what_the_matrix_says(camera, pose, texels, pattern):
    random = np.random.default_rng(texels)
    value, noise = random.random((2, SPEC.height, SPEC.width)).astype(np.float32)
    value[random.random(value.shape) < 0.01] = np.nan
    noise[np.isnan(value)] = np.nan
    noise[random.random(value.shape) < 0.005] = np.inf
    of = Rectifier(value, noise, pattern, camera, pose, TexelGrid(texels))
    for one, other in zip(of.rows(0, texels), means_of_rows(of, 0, texels), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-3, atol=1e-4)


def test_what_lies_beyond_the_picture_is_not_seen():
    flat = texels_of(flat_picture(), Camera(SPEC), ALIGNMENT.pose(0.0, 0.0), TexelGrid(50, 200.0))
    assert np.isnan(flat.value[:, 0, 0]).all()
    assert flat.value[:, 25, 25] == pytest.approx(1.0)
