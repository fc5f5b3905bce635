"""Differences of colors, and the matrix that a chart gives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gonio.chart import GREYS, patch_names, published_xyz
from gonio.color import D65, XYZ_FROM_SRGB, lab_from_xyz, xyz_from_lab
from gonio.colorimetry.difference import delta_e_2000
from gonio.colorimetry.matrix import fit_matrix, lab_slope, matrix_errors
from gonio.errors import BadInputError

XYZ = published_xyz()


# of the 34 pairs of Sharma, Wu and Dalal (2005), those at the formula's corners
@pytest.mark.parametrize(
    ("one", "other", "published"),
    [
        ((50, 2.6772, -79.7751), (50, 0, -82.7485), 2.0425),
        ((50, 3.1571, -77.2803), (50, 0, -82.7485), 2.8615),
        ((50, -1.3802, -84.2814), (50, 0, -82.7485), 1.0000),
        ((50, 0, 0), (50, -1, 2), 2.3669),
        ((50, 2.49, -0.001), (50, -2.49, 0.0009), 7.1792),
        ((50, 2.49, -0.001), (50, -2.49, 0.0011), 7.2195),
        ((50, 2.5, 0), (50, 0, -2.5), 4.3065),
        ((50, 2.5, 0), (73, 25, -18), 27.1492),
        ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
        ((22.7233, 20.0904, -46.6940), (23.0331, 14.9730, -42.5619), 2.0373),
        ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
    ],
)
def test_ciede2000_is_as_published(one, other, published):
    xyz = xyz_from_lab([one, other], D65)
    assert delta_e_2000(xyz[0], xyz[1]) == pytest.approx(published, abs=1e-4)
    assert delta_e_2000(xyz[1], xyz[0]) == pytest.approx(published, abs=1e-4)


def balanced(rows):
    """Return a camera's matrix from linear sRGB, each row's sum one."""
    matrix = np.eye(3) + 0.3 * rows
    return matrix / matrix.sum(axis=1, keepdims=True)


CAMERAS = arrays(np.float64, (3, 3), elements=st.floats(0.0, 1.0)).map(balanced)


@given(CAMERAS)
def test_a_linear_camera_is_found_to_the_last_digits(camera):
    seen = XYZ @ np.linalg.inv(XYZ_FROM_SRGB).T @ camera.T
    true = XYZ_FROM_SRGB @ np.linalg.inv(camera)
    np.testing.assert_allclose(fit_matrix(seen, XYZ), true, atol=1e-6)


@given(CAMERAS, st.integers(0, 1000))
def test_white_is_kept_whatever_the_patches_say(camera, seed):
    seen = XYZ @ np.linalg.inv(XYZ_FROM_SRGB).T @ camera.T
    off = 1.0 + np.random.default_rng(seed).normal(scale=0.05, size=seen.shape)
    np.testing.assert_allclose(fit_matrix(seen * off, XYZ) @ np.ones(3), D65, rtol=1e-12)


def test_the_matrix_errs_as_its_errors_say():
    random, camera = np.random.default_rng(5), balanced(np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]]))
    seen = XYZ @ np.linalg.inv(XYZ_FROM_SRGB).T @ camera.T
    true, white_sigma = XYZ_FROM_SRGB @ np.linalg.inv(camera), np.array([0.003, 0.001, 0.002])
    scores = []
    for _ in range(200):
        shared = 1.0 + white_sigma * random.normal(size=3)
        # what a camera's matrix leaves is alike in all lightnesses
        off = np.linalg.solve(lab_slope(XYZ), random.normal(scale=0.3, size=(24, 3, 1)))[..., 0]
        noisy = (seen + off @ np.linalg.inv(true).T) / shared
        errors = matrix_errors(noisy, XYZ, white_sigma)
        away = (fit_matrix(noisy, XYZ) - true) @ [0.6, 0.2, 0.1]
        scores.append(away / np.linalg.norm(errors @ [0.6, 0.2, 0.1], axis=0))
    assert errors.shape == (9, 3, 3)
    np.testing.assert_allclose(errors @ np.ones(3), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.std(scores, axis=0), 1.0, atol=0.2)


def test_the_slope_is_that_of_cielab():
    step = 1e-6 * np.eye(3)
    ends = [(lab_from_xyz(XYZ + s, D65) - lab_from_xyz(XYZ - s, D65)) / 2e-6 for s in step]
    np.testing.assert_allclose(lab_slope(XYZ), np.stack(ends, axis=-1), rtol=1e-4, atol=1e-4)


def test_greys_alone_tell_no_matrix():
    grey = np.repeat(XYZ[GREYS, 1:2], 3, axis=1)
    with pytest.raises(BadInputError, match="do not tell colors apart"):
        fit_matrix(grey, grey * D65)


def test_the_chart_is_as_published():
    assert len(patch_names()) == 24
    assert patch_names()[0] == "dark skin"
    # the white patch reflects 88 to 90 %, and greys fall from there
    luminance = XYZ[GREYS, 1]
    assert 0.87 < luminance[0] < 0.91
    assert (np.diff(luminance) < 0).all()
