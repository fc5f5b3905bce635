"""Frames straight from the twin's camera, and what a reader of the files finds in them."""

import io

import numpy as np
import rawpy
import tifffile

from gonio.geometry import ArmPose
from gonio.rig import default_rig

RIG = default_rig()
ALL_ON = np.ones(11)
OFF = np.zeros(11)
NORMAL = ArmPose.from_degrees(0, 0)
OBLIQUE = ArmPose.from_degrees(45, 0)


def frame(
    camera,
    *,
    holder="sample",
    view=OBLIQUE,
    light=NORMAL,
    flux=ALL_ON,
    s=0.2,
    key="frame",
    **warmth,
):
    scene = {"holder": holder, "view": view, "light": light, "flux": flux}
    return camera.frame(**scene, exposure_s=s, key=key, **warmth)


def raw_of(data):
    with rawpy.imread(io.BytesIO(data)) as raw:
        return raw.raw_image.astype(np.float64)


def tags_of(data):
    with tifffile.TiffFile(io.BytesIO(data)) as tiff:
        return {tag.code: tag.value for tag in tiff.pages[0].tags}
