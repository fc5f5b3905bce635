"""Pictures for whoever watches: the last frame, and the material as far as it is known."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadFileError
from gonio.reduce.raw import decode_raw, read_vouched

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.journal import FrameRecord
    from gonio.reduce.raw import RawFrame

_WIDTH_PX = 480
_SPHERE_PX = 72
_WHITE_QUANTILE = 0.995
_REMEDY = "see that the folder is the session's own"


def frame_png(root: Path, record: FrameRecord) -> bytes:
    """Return a frame as a small PNG in the camera's own colours, stretched to what it holds.

    Raises
    ------
    gonio.errors.BadFileError
        When the file is missing, has changed, is no frame, or lies outside of the session.
    """
    path = root / record.file
    if not path.resolve().is_relative_to(root.resolve()):
        raise BadFileError(path, "lies outside of the session", _REMEDY)
    raw = decode_raw(read_vouched(path, record.sha256, _REMEDY), path, _REMEDY)
    return _png(_stretched(_binned(raw)))


def sphere_png(values: NDArray[np.floating]) -> bytes:
    """Return values of the 81 x 81 grid, shape (81, 81, channels), as a sphere on nothing."""
    from gonio.materials import MeasuredTable
    from nnbrdf.sphere import shade_sphere, sphere_cover, tone_map

    cover = sphere_cover(_SPHERE_PX)
    material = MeasuredTable.of(np.broadcast_to(values, (*values.shape[:2], 3)).astype(np.float64))
    color = shade_sphere(material, _SPHERE_PX) / cover.clip(0.1)[..., None]
    alpha = np.round(255 * cover).astype(np.uint8)
    return _png(np.dstack([tone_map(color), alpha]))


def _binned(raw: RawFrame) -> NDArray[np.float64]:
    """Return one colour for each cell of the filter, above black, from 0 to 1."""
    height, width = (side // 2 * 2 for side in raw.mosaic.shape)
    # of a large sensor every so many cells do
    step = 2 * max(1, width // (2 * _WIDTH_PX))
    cells = [raw.mosaic[row:height:step, column:width:step] for row in (0, 1) for column in (0, 1)]
    planes = [
        np.mean(
            [cell for cell, name in zip(cells, raw.sensor.pattern, strict=True) if name == c], 0
        )
        for c in "RGB"
    ]
    return (np.dstack(planes) - raw.sensor.black) / (raw.sensor.white - raw.sensor.black)


def _stretched(linear: NDArray[np.float64]) -> NDArray[np.uint8]:
    from nnbrdf.sphere import encode_srgb

    white = max(float(np.quantile(linear, _WHITE_QUANTILE)), 1e-6)
    return np.round(255 * encode_srgb(linear / white)).astype(np.uint8)


def _png(picture: NDArray[np.uint8]) -> bytes:
    import cv2

    order = [2, 1, 0, 3][: picture.shape[2]]
    return cv2.imencode(".png", np.ascontiguousarray(picture[..., order]))[1].tobytes()
