"""How different two materials look: pictures of one sphere, compared pixel by pixel."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError, MissingExtraError
from nnbrdf.sphere import encode_srgb, shade_sphere, sphere_cover
from nnbrdf.sphere_table import shade_table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material

SIZE_PX = 128


def expose_sphere(material: Material | NDArray[Any], white: float) -> NDArray[np.uint8]:
    """Render a sphere as a camera without highlight recovery would: exposed by white, clipped.

    The scene is that of `nnbrdf.sphere.shade_sphere`: a softbox from the upper left, in which body
    and highlight show, a weak light at grazing incidence, and the grain along the circles of
    latitude.

    Parameters
    ----------
    material
        Evaluated at every ray; or a table, shape (81, 81, 3), in 1/sr, interpolated.
    white
        BRDF in 1/sr that, facing the softbox, just reaches 255.

    Returns
    -------
    ndarray
        8-bit sRGB, shape (n, 3), of the pixels that lie wholly on the sphere.

    Raises
    ------
    gonio.errors.BadInputError
        When a table's shape is another, a number is not finite, or white is not positive.
    """
    check_white(white)
    if isinstance(material, np.ndarray):
        shaded = shade_table(material, SIZE_PX)
    else:
        shaded = shade_sphere(material, SIZE_PX)
    # the light makes 1 of a white diffuser, whose BRDF is 1/pi
    linear = shaded[_mask()] / (np.pi * white)
    if not np.isfinite(linear).all():
        raise BadInputError("the material has values that are not finite; make it again")
    return np.round(255.0 * encode_srgb(linear)).astype(np.uint8)


def psnr_db(estimate: NDArray[np.uint8], true: NDArray[np.uint8]) -> float:
    """Return the peak signal-to-noise ratio of two 8-bit pictures, 10 log10(255^2 / MSE), in dB.

    The mean is over all pixels and channels. Of identical pictures it is infinite.
    """
    square = np.mean((estimate.astype(np.float64) - true) ** 2)
    return float(10.0 * np.log10(255.0**2 / square)) if square else np.inf


def delta_e_2000(estimate: NDArray[np.uint8], true: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return the CIEDE2000 color difference of each pixel of 8-bit sRGB, shape (n,).

    CIE 142-2001 with all parametric factors 1, by colour-science; D65, 2 degree observer.

    Raises
    ------
    gonio.errors.MissingExtraError
        Without the extra `color`.
    """
    try:
        import colour
    except ImportError:
        raise MissingExtraError("colour-science", "color") from None
    one, other = (colour.XYZ_to_Lab(colour.sRGB_to_XYZ(each / 255.0)) for each in (estimate, true))
    return np.asarray(colour.delta_E(one, other, method="CIE 2000"), np.float64)


def check_white(white: float) -> None:
    """Refuse an exposure that is none.

    Raises
    ------
    gonio.errors.BadInputError
        When white is not positive.
    """
    if not white > 0:
        raise BadInputError(f"white is {white:g}, not positive; it scales the errors")


@cache
def _mask() -> NDArray[np.bool_]:
    return np.equal(sphere_cover(SIZE_PX), 1.0)
