"""Stray light: what the twin's lens spreads, seen in the dark room beside the board."""

from pathlib import Path

import numpy as np
import pytest

from gonio.calibrate.glare import away_from_board_px, stray_light_of
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
    away_px, bad = away_from_board_px(RIG.camera, view), np.zeros(channel.shape, np.bool_)
    return stray_light_of(signals, away_px, channel, bad)


@pytest.mark.parametrize("share", [0.0, 0.005, 0.03])
def test_the_share_is_found_whatever_halo_there_is(share):
    found = seen(STEEP, camera_glare=share, camera_halo=0.03)
    assert found.share == pytest.approx(share, abs=2e-4)
    assert found.sigma < 2e-4


def test_where_the_board_fills_the_picture_nothing_is_told():
    assert seen(ArmPose.from_degrees(0.0, 0.0), camera_glare=0.03) is None


@pytest.mark.parametrize(("share", "width"), [(0.03, 0.05), (0.01, 0.03)])
def test_the_halo_is_found_beside_the_veil(share, width):
    found = seen(STEEP, camera_glare=0.01, camera_halo=share, camera_halo_width=width)
    # three boxes of whole pixels are a bell of 8.5 px and 4.7 px
    assert found.halo.share == pytest.approx(share, rel=0.12)
    assert 160 * found.halo.width == pytest.approx({0.05: 8.5, 0.03: 4.7}[width], rel=0.12)
    assert found.halo.sigma < 0.05 * share


def test_without_a_halo_hardly_one_is_found():
    found = seen(STEEP, camera_glare=0.01)
    assert found.halo is None or found.halo.share < 5e-4
