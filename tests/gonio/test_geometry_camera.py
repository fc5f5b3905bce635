"""The arm's frame and the camera against the words of the protocol."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.camera import Camera
from gonio.directions import from_spherical
from gonio.geometry import ArmPose
from gonio.rig import default_rig

SPEC = default_rig().camera
WIDE = SPEC.model_copy(update={"focal_px": 400.0, "distortion": (-0.25, 0.1, 0.001, -0.002, 0.01)})

THETA = st.floats(0.0, math.radians(89.0))
PHI = st.floats(-0.1, 6.4)
POSE = st.builds(ArmPose, THETA, PHI)


@given(POSE)
def test_up_is_minus_the_direction_by_theta(pose):
    step = 1e-6
    ahead, behind = (ArmPose(pose.theta + s, pose.phi).direction for s in (step, -step))
    np.testing.assert_allclose(pose.up, -(ahead - behind) / (2 * step), atol=1e-9)


@given(POSE)
def test_right_is_forward_cross_up_and_the_frame_is_orthonormal(pose):
    np.testing.assert_allclose(pose.right, np.cross(-pose.direction, pose.up), atol=1e-15)
    frame = np.stack([pose.right, pose.up, pose.direction])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(pose.direction, from_spherical(pose.theta, pose.phi), atol=1e-15)


def test_at_the_pole_the_azimuth_turns_the_frame():
    """From above at phi = 0, up is -x and right is +y; phi turns both about z."""
    np.testing.assert_allclose(ArmPose(0.0, 0.0).up, [-1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(ArmPose(0.0, 0.0).right, [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(ArmPose.from_degrees(0.0, 90.0).up, [0, -1, 0], atol=1e-15)
    np.testing.assert_allclose(ArmPose.from_degrees(0.0, 90.0).right, [-1, 0, 0], atol=1e-15)


def test_place_is_along_the_frame():
    pose = ArmPose.from_degrees(30.0, 40.0)
    point = pose.place(2000.0, x_mm=15.0, y_mm=-4.0)
    assert point @ pose.direction == pytest.approx(2000.0)
    assert point @ pose.right == pytest.approx(15.0)
    assert point @ pose.up == pytest.approx(-4.0)


@given(POSE)
@settings(deadline=None)
def test_the_centre_is_seen_at_the_principal_point(pose):
    pixel = Camera(SPEC).project([0.0, 0.0, 0.0], pose)
    np.testing.assert_allclose(pixel, [SPEC.centre_px], atol=1e-9)


@given(POSE)
@settings(deadline=None)
def test_columns_run_along_right_and_rows_against_up(pose):
    centre, right, up = Camera(SPEC).project([[0, 0, 0], pose.right, pose.up], pose)
    scale = SPEC.focal_px / (1000 * SPEC.distance_m)
    np.testing.assert_allclose(right - centre, [scale, 0.0], atol=1e-9)
    np.testing.assert_allclose(up - centre, [0.0, -scale], atol=1e-9)


@given(pose=POSE, spec=st.sampled_from([SPEC, WIDE]))
@settings(max_examples=30, deadline=None)
def test_each_pixel_sees_its_point_of_the_plane(pose, spec):
    camera = Camera(spec)
    points = camera.plane_points(pose)[::20, ::20].reshape(-1, 3)
    rows, columns = np.mgrid[: spec.height : 20, : spec.width : 20]
    pixels = np.stack([columns, rows], axis=-1).reshape(-1, 2)
    hit = np.isfinite(points[:, 0])
    assert hit.any()
    assert (points[hit, 2] == 0).all()
    np.testing.assert_allclose(camera.project(points[hit], pose), pixels[hit], atol=1e-5)


def test_distortion_moves_the_corners():
    pose, corner = ArmPose.from_degrees(20.0, 0.0), [[300.0, 300.0, 0.0]]
    straight = WIDE.model_copy(update={"distortion": ()})
    plain, bent = (Camera(spec).project(corner, pose) for spec in (straight, WIDE))
    assert np.abs(plain - bent).max() > 0.5


def test_rays_that_miss_the_plane_are_nan():
    """At grazing view, the upper part of a wide picture looks over the horizon."""
    wide = SPEC.model_copy(update={"focal_px": 100.0})
    points = Camera(wide).plane_points(ArmPose.from_degrees(75.0, 0.0))
    assert np.isnan(points[0]).all()
    assert np.isfinite(points[-1]).all()
