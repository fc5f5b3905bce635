"""A material on a sphere as a picture within the page."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.sphere import shade_sphere, sphere_cover, tone_map

if TYPE_CHECKING:
    from gonio.protocols import Material

_SIZE_PX = 180


def sphere_uri(material: Material, white: float) -> str:
    """Render a material as a PNG data URI, exposed like the maps, around it transparent."""
    from matplotlib.image import imsave

    cover = sphere_cover(_SIZE_PX)[..., None]
    # the light makes 1 of a white diffuser, whose BRDF is 1/pi
    exposed = shade_sphere(material, _SIZE_PX) / (np.pi * white)
    color = tone_map(exposed / cover.clip(0.1))
    alpha = np.round(255.0 * cover).astype(np.uint8)
    buffer = io.BytesIO()
    imsave(buffer, np.concatenate([color, alpha], axis=-1))
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode()
