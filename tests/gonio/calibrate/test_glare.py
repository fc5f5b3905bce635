"""Stray light: what the twin's lens spreads, seen in the dark room beside the board."""

from pathlib import Path

import numpy as np
import pytest

from gonio.calibrate.glare import dark_room, stray_light_of
from gonio.geometry import ArmPose
from gonio.materials import Lambertian
from gonio.reduce.raw import decode_raw
from gonio.rig import default_rig
from sim.camera import SimCamera
from sim.camera_imperfections import CameraImperfections

RIG = default_rig()
STEEP = ArmPose.from_degrees(75.0, 180.0)
LIGHT = ArmPose.from_degrees(45.0, 0.0)


def seen(view, **sizes):
    """Return what two frames tell of the share of stray light."""
    camera = SimCamera(RIG, Lambertian(0.9), 1, CameraImperfections(**sizes))
    signals = []
    for key in ("one", "two"):
        data = camera.frame(
            holder="reference", view=view, light=LIGHT, flux=np.ones(11), exposure_s=0.5, key=key
        )
        raw = decode_raw(data, Path("frame.dng"), "")
        signals.append(raw.mosaic.astype(float) - raw.sensor.black)
    channel = raw.sensor.channel(*np.indices(raw.mosaic.shape))
    return stray_light_of(signals, dark_room(RIG.camera, view), channel)


@pytest.mark.parametrize("share", [0.0, 0.005, 0.03])
def test_the_share_is_found_whatever_halo_there_is(share):
    found = seen(STEEP, camera_glare=share, camera_halo=0.03)
    assert found.share == pytest.approx(share, abs=2e-4)
    assert found.sigma < 2e-4


def test_where_the_board_fills_the_picture_nothing_is_told():
    assert seen(ArmPose.from_degrees(0.0, 0.0), camera_glare=0.03) is None
