"""The twin's lens: everything in the way of light between the sample and the sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.optics.defocus import confusion_px, defocus
from sim.optics.stray_light import halo, veiling_glare
from sim.optics.vignetting import natural_falloff, optical_falloff

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gonio.rig import CameraSpec
    from sim.camera_imperfections import CameraImperfections


class Lens:
    """Turns an ideal image into the one that falls on the sensor.

    Parameters
    ----------
    spec
        The camera, focused on the sample's centre.
    imperfections
        How large each is.
    """

    def __init__(self, spec: CameraSpec, imperfections: CameraImperfections) -> None:
        self._spec, self._sizes = spec, imperfections
        falloff = optical_falloff(spec, imperfections.camera_vignetting)
        if imperfections.camera_cos4:
            falloff = falloff * natural_falloff(spec)
        self._falloff = falloff[..., None]

    def image(
        self, radiance: NDArray[np.float64], nearer_mm: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return what falls on the sensor.

        Parameters
        ----------
        radiance
            Of what each pixel sees, shape (height, width, 3).
        nearer_mm
            By how much that is nearer than the sample's centre, shape (height, width).
        """
        sizes = self._sizes
        image = self._falloff * defocus(radiance, self._confusion_px(nearer_mm))
        if sizes.camera_halo:
            image = halo(image, sizes.camera_halo, sizes.camera_halo_width * self._spec.width)
        if sizes.camera_glare:
            image = veiling_glare(image, sizes.camera_glare)
        return image

    def _confusion_px(self, nearer_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        return confusion_px(
            nearer_mm,
            distance_mm=1000.0 * self._spec.distance_m,
            aperture_mm=self._sizes.aperture_mm,
            focal_px=self._spec.focal_px,
        )
