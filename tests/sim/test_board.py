"""The ChArUco board as OpenCV's own detector sees it in the twin's frames."""

import cv2
import numpy as np
import pytest

from gonio.board import charuco_board, corner_points_mm
from gonio.camera import Camera
from gonio.geometry import ArmPose
from gonio.materials import Lambertian
from sim import sensor
from sim.camera import SimCamera
from sim.imperfections import BY_NAME
from sim.materials import load_material

from .frames import NORMAL, OBLIQUE, RIG, frame, raw_of

# 8 px/mm, as the protocol asks for at normal view
SHARP = RIG.model_copy(
    update={
        "camera": RIG.camera.model_copy(
            update={"width": 1100, "height": 1100, "focal_px": 16000.0, "centre_px": (549.5, 549.5)}
        )
    }
)
BOARD = charuco_board()


def corners_of(view, light, name):
    """Return the corners found, in pixels, and where they truly are."""
    camera = SimCamera(SHARP, load_material("charuco"), 1, BY_NAME[name].of_camera)
    raw = raw_of(frame(camera, view=view, light=light, s=0.4)) - sensor.BLACK_LEVEL
    balanced = raw.copy()
    for place, color in enumerate(sensor.CFA):
        balanced[place // 2 :: 2, place % 2 :: 2] /= sensor.CAMERA_NEUTRAL["RGB".index(color)]
    image = (255 * (balanced / np.percentile(balanced, 99)).clip(0, 1) ** 0.5).astype(np.uint8)
    found, ids, _, _ = cv2.aruco.CharucoDetector(BOARD).detectBoard(image)
    points_mm = corner_points_mm(ids.ravel())
    at = BOARD.getChessboardCorners()[ids.ravel()]
    # the protocol's words for OpenCV's board coordinates
    np.testing.assert_allclose(points_mm[:, :2], np.stack([at[:, 0] - 65, 65 - at[:, 1]], 1))
    return found.reshape(-1, 2), Camera(SHARP.camera).project(points_mm, view)


@pytest.mark.parametrize(
    ("view", "light", "name"),
    [(NORMAL, OBLIQUE, "none"), (ArmPose.from_degrees(40, 0), NORMAL, "mild")],
    ids=["above", "oblique"],
)
def test_every_corner_is_found_where_it_is(view, light, name):
    found, true = corners_of(view, light, name)
    assert len(found) == 144
    assert np.hypot(*(found - true).T).mean() < 0.1


def test_a_coarse_picture_of_it_is_as_bright_as_its_mean():
    board = load_material("charuco")
    mean = np.pi * board.evaluate(NORMAL.direction, NORMAL.direction)[0]
    one, other = (
        raw_of(frame(SimCamera(RIG, it, 1), view=NORMAL, light=OBLIQUE))[30:130:2, 31:130:2]
        for it in (board, Lambertian(mean))
    )
    black = sensor.BLACK_LEVEL
    assert one.mean() - black == pytest.approx(other.mean() - black, rel=0.05)
