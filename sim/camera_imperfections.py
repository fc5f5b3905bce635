"""How far the twin's camera and lamps are from ideal ones: one size for each imperfection."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import Field

from gonio.validation import Document, within
from sim.pixels.full_well import LARGEST_SHORTFALL

Share = Annotated[float, within(0, 1)]
Electrons = Annotated[float, within(0, 1e4)]
PerDegree = Annotated[float, within(-0.01, 0.01)]


class CameraImperfections(Document):
    """Sizes of everything that is not ideal; as it is made without arguments, nothing is.

    Attributes
    ----------
    camera_prnu
        Standard deviation of the pixels' response, relative.
    camera_dsnu_e, camera_column_e
        Standard deviation of the pixels' and of the columns' offset, in electrons.
    camera_dark_e_per_s
        Dark current at 25 deg C, in electrons a second and pixel.
    camera_dark_doubling_c
        Degrees that double it.
    camera_sensor_rise_c
        By how much a sensor in use for long is warmer than the room.
    camera_hot_share, camera_hot_times
        How many of all pixels are hot, and by how many times the dark current on average.
    camera_full_well
        Share of electrons missing where the full well is just reached.
    camera_end
        Share of the range from BlackLevel to WhiteLevel at which raw values end.
    camera_cos4
        Whether the picture's edges are darker by the field angle.
    camera_vignetting
        Share of light that the lens' rims take from the farthest pixel.
    camera_focal_mm, camera_f_number
        Of the lens, for defocus; an f-number of 0 is a pinhole, which is sharp everywhere.
    camera_glare
        Share of all light that is spread evenly over the frame.
    camera_halo, camera_halo_width
        Share of each pixel's light that is spread about it, and the standard deviation of that as a
        share of the frame's width.
    lamp_red_per_c, lamp_blue_per_c
        Change of a lamp's red and blue against its green, relative, for each deg C of its junction.
    lamp_electronics_us
        Time constant of a lamp's current after a change.
    """

    camera_prnu: Annotated[float, within(0, 0.1)] = 0.0
    camera_dsnu_e: Electrons = 0.0
    camera_column_e: Electrons = 0.0
    camera_dark_e_per_s: Electrons = 0.0
    camera_dark_doubling_c: Annotated[float, within(1, 100)] = 6.0
    camera_sensor_rise_c: Annotated[float, within(0, 60)] = 0.0
    camera_hot_share: Share = 0.0
    camera_hot_times: Annotated[float, within(0, 1e6)] = 100.0
    camera_full_well: Annotated[float, within(0, LARGEST_SHORTFALL)] = 0.0
    camera_end: Annotated[float, within(0.1, 1)] = Field(
        default=1.0, exclude_if=lambda it: it == 1.0
    )
    camera_cos4: bool = False
    camera_vignetting: Share = 0.0
    camera_focal_mm: Annotated[float, within(1, 1e4)] = 100.0
    camera_f_number: Annotated[float, within(0, 1e3)] = 0.0
    camera_glare: Share = 0.0
    camera_halo: Share = 0.0
    camera_halo_width: Annotated[float, within(0, 1)] = 0.05
    lamp_red_per_c: PerDegree = 0.0
    lamp_blue_per_c: PerDegree = 0.0
    lamp_electronics_us: Annotated[float, within(0, 1e6)] = 0.0

    @property
    def aperture_mm(self) -> float:
        """Diameter of the lens' opening; 0 for a pinhole."""
        return self.camera_focal_mm / self.camera_f_number if self.camera_f_number else 0.0


NONE: Final = CameraImperfections()

MILD: Final = CameraImperfections(
    camera_prnu=0.005,
    camera_dsnu_e=1.0,
    camera_column_e=0.5,
    camera_dark_e_per_s=1.0,
    camera_sensor_rise_c=6.0,
    camera_hot_share=1e-4,
    camera_full_well=0.01,
    camera_cos4=True,
    camera_vignetting=0.05,
    camera_f_number=8.0,
    camera_glare=0.005,
    camera_halo=0.005,
    lamp_red_per_c=-2e-4,
    lamp_blue_per_c=1e-4,
    lamp_electronics_us=5.0,
)
"""Of a good camera, chosen with care, and of good lamps."""

ALL: Final = CameraImperfections(
    camera_prnu=0.02,
    camera_dsnu_e=5.0,
    camera_column_e=3.0,
    camera_dark_e_per_s=20.0,
    camera_sensor_rise_c=15.0,
    camera_hot_share=1e-3,
    camera_full_well=0.05,
    camera_cos4=True,
    camera_vignetting=0.3,
    camera_f_number=2.8,
    camera_glare=0.03,
    camera_halo=0.03,
    lamp_red_per_c=-1e-3,
    lamp_blue_per_c=3e-4,
    lamp_electronics_us=50.0,
)
"""Each large enough to be seen."""
