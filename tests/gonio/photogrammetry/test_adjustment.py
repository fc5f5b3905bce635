"""Bundle adjustment of corners with noise against the arm and camera that they were seen from."""

import numpy as np
import pytest

from gonio.alignment import ALIGNED, Alignment
from gonio.errors import BadInputError
from gonio.photogrammetry.adjustment import adjust
from gonio.photogrammetry.model import ARM

from .views import FINE, POSES_DEG, corners_seen

MISALIGNED = Alignment(
    theta_offset_deg=0.3,
    phi_offset_deg=-0.4,
    phi_tilt_x_deg=0.2,
    phi_tilt_y_deg=-0.15,
    theta_tilt_deg=0.1,
    roll_deg=0.25,
    distance_mm=3.0,
    centre_x_mm=0.5,
    centre_y_mm=-0.4,
    centre_z_mm=0.3,
)
LENS = {"distortion": (-0.2, 0.0, 1e-3, -1e-3, 0.0)}
CAMERAS = {
    # the rig file's distortion, what is true instead
    "pinhole": ((), {"focal_px": 28100.0, "centre_px": (1005.0, 990.0)}),
    "lens": ((-0.1, 0.0, 0.0, 0.0, 0.0), {"focal_px": 28050.0} | LENS),
}


def truth_of(spec, alignment):
    values = (spec.focal_px, *spec.centre_px, *spec.distortion)
    return np.array([*values, *alignment.model_dump().values()])


@pytest.mark.parametrize(("known", "true"), CAMERAS.values(), ids=CAMERAS)
def test_what_was_put_in_is_found_within_its_uncertainty(known, true):
    spec = FINE.model_copy(update=true)
    views = corners_seen(spec, MISALIGNED, off_deg=0.005)
    found = adjust(FINE.model_copy(update={"distortion": known}), views)
    sigma = np.sqrt(np.diag(found.covariance))
    off = found.values - truth_of(spec, MISALIGNED)
    assert (np.abs(off) < 4.0 * sigma).all()
    sigmas = dict(zip(found.names, sigma, strict=True))
    assert max(sigmas[name] for name in ARM if name.endswith("deg")) < 0.003
    assert max(sigmas[f"centre_{axis}_mm"] for axis in "xyz") < 0.001
    # focal length and distance nearly trade places
    assert sigmas["distance_mm"] < 0.3
    assert np.sqrt(np.mean(found.errors_px**2)) == pytest.approx(0.02, rel=0.05)


def test_an_arm_with_more_play_than_expected_leaves_more_uncertain():
    scores = []
    for seed in range(3):
        found = adjust(FINE, corners_seen(FINE, MISALIGNED, off_deg=0.05, seed=seed))
        sigma = np.sqrt(np.diag(found.covariance))
        scores.append((found.values - truth_of(FINE, MISALIGNED)) / sigma)
    assert 0.5 < np.sqrt(np.mean(np.square(scores))) < 1.4
    assert np.abs(scores).max() < 4.0


def test_one_in_fifty_corners_may_be_anywhere():
    views = corners_seen(FINE, MISALIGNED)
    random = np.random.default_rng(1)
    for view in views:
        wrong = random.random(len(view.ids)) < 0.02
        view.pixels[wrong] += random.normal(0.0, 20.0, (wrong.sum(), 2))
    found = adjust(FINE, views).state.alignment
    for name, wanted in MISALIGNED.model_dump().items():
        tolerance = 1.0 if name == "distance_mm" else 0.005
        assert getattr(found, name) == pytest.approx(wanted, abs=tolerance), name


BAD = {
    "few views": (POSES_DEG[:5], "the board was found in 5 views, and 6 are needed"),
    "one pose": (POSES_DEG[:1] * 8, "the views leave"),
    "one ring": ([(20.0, phi) for phi in range(0, 360, 40)], "the views leave"),
    "one azimuth": ([(theta, 0.0) for theta in range(0, 70, 10)], "the views leave"),
}


@pytest.mark.parametrize(("poses_deg", "message"), BAD.values(), ids=BAD)
def test_views_that_tell_too_little_are_refused(poses_deg, message):
    with pytest.raises(BadInputError, match=message):
        adjust(FINE, corners_seen(FINE, ALIGNED, poses_deg))
