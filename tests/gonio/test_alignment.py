"""An arm that is not quite as its rig file says."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.alignment import ALIGNED, AlignedPose, Alignment
from gonio.camera import Camera
from gonio.geometry import ArmPose
from gonio.rig import default_rig

SPEC = default_rig().camera
ANGLE = st.floats(-2.0, 2.0)
ALIGNMENT = st.builds(Alignment, **dict.fromkeys(Alignment.model_fields, ANGLE))
THETA, PHI = st.floats(0.0, 85.0), st.floats(0.0, 360.0)


@given(THETA, PHI)
def test_without_errors_it_is_the_arm_itself(theta, phi):
    plain = ArmPose.from_degrees(theta, phi)
    assert ALIGNED.pose(theta, phi) == plain
    spelled = AlignedPose(plain.theta, plain.phi)
    for name in ("right", "up", "direction"):
        np.testing.assert_allclose(getattr(spelled, name), getattr(plain, name), atol=1e-15)


@given(ALIGNMENT, THETA, PHI)
def test_frames_stay_right_handed(alignment, theta, phi):
    frame = alignment.frames(math.radians(theta), math.radians(phi))
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(np.cross(frame[0], frame[1]), frame[2], atol=1e-14)


@given(ALIGNMENT, THETA, PHI)
def test_the_axes_meet_at_the_principal_point(alignment, theta, phi):
    pose = alignment.pose(theta, phi)
    pixel = Camera(SPEC).project(alignment.centre_mm, pose)
    np.testing.assert_allclose(pixel, [SPEC.centre_px], atol=1e-6)
    eye = pose.place(1000 * SPEC.distance_m)
    reach = np.linalg.norm(eye - alignment.centre_mm)
    assert reach == pytest.approx(1000 * SPEC.distance_m + alignment.distance_mm)


LAWS = {
    "theta_offset_deg": ArmPose.from_degrees(41.0, 30.0).direction,
    "phi_offset_deg": ArmPose.from_degrees(40.0, 31.0).direction,
    "roll_deg": ArmPose.from_degrees(40.0, 30.0).direction,
}


@pytest.mark.parametrize(("name", "direction"), LAWS.items(), ids=LAWS)
def test_offsets_are_of_the_axis_they_are_named_for(name, direction):
    pose = Alignment(**{name: 1.0}).pose(40.0, 30.0)
    np.testing.assert_allclose(pose.direction, direction, atol=1e-14)


@pytest.mark.parametrize(
    ("name", "moved"), [("phi_tilt_x_deg", (0, -1, 0)), ("phi_tilt_y_deg", (1, 0, 0))]
)
def test_a_tilted_phi_axis_turns_about_the_sample_s_axes(name, moved):
    upright = Alignment(**{name: 1.0}).pose(0.0, 0.0).direction
    np.testing.assert_allclose(upright[:2], math.sin(math.radians(1.0)) * np.array(moved)[:2])


@given(PHI)
def test_a_tilted_theta_axis_moves_an_upright_camera_aside(phi):
    """By the tilt across the arm; a level camera is turned about its own line of sight."""
    tilt = Alignment(theta_tilt_deg=1.0)
    plain, pose = ArmPose.from_degrees(0.0, phi), tilt.pose(0.0, phi)
    assert abs(pose.direction @ plain.right) == pytest.approx(math.sin(math.radians(1.0)))
    level = tilt.pose(90.0, phi)
    np.testing.assert_allclose(
        level.direction, ArmPose.from_degrees(90.0, phi).direction, atol=1e-14
    )
