"""The pose of one shot, by encoders and board."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gonio.alignment import AlignedPose
from gonio.photogrammetry.adjustment import adjust
from gonio.photogrammetry.geometry_file import Geometry
from gonio.photogrammetry.refinement import refined_pose
from gonio.rig import default_rig

from .test_adjustment import MISALIGNED
from .views import FINE, corners_seen

TRUE_DEG = (40.02, 99.97)
ENCODERS = {"theta": math.radians(40.0), "phi": math.radians(100.0)}


@pytest.fixture(scope="module")
def geometry():
    return Geometry.of(default_rig(), adjust(FINE, corners_seen(FINE, MISALIGNED)))


@pytest.fixture
def view():
    """The board from an arm that is 0.02 and 0.03 deg off its encoders."""
    (seen,) = corners_seen(FINE, MISALIGNED, [TRUE_DEG])
    return replace(seen, **ENCODERS)


def kept(view, which):
    return replace(view, ids=view.ids[which], pixels=view.pixels[which])


@pytest.mark.parametrize("share", [1.0, 0.5], ids=["whole", "half hidden"])
def test_the_board_tells_what_the_encoders_miss(geometry, view, share):
    pose = refined_pose(geometry, FINE, kept(view, view.ids < 144 * share))
    assert math.degrees(pose.theta) == pytest.approx(TRUE_DEG[0], abs=2e-3)
    assert math.degrees(pose.phi) == pytest.approx(TRUE_DEG[1], abs=2e-3)


def test_no_board_leaves_encoders_and_alignment(geometry, view):
    pose = refined_pose(geometry, FINE, kept(view, view.ids < 0))
    assert pose == AlignedPose(**ENCODERS, alignment=geometry.view)


def test_a_board_that_contradicts_the_geometry_is_not_followed(geometry, view):
    pose = refined_pose(geometry, FINE, replace(view, pixels=view.pixels + np.array([0.0, 40.0])))
    assert (pose.theta, pose.phi) == (ENCODERS["theta"], ENCODERS["phi"])
