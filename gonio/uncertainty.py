"""What sigma is made of, and what a rig file states of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Final

from pydantic import Field

from gonio.validation import Document, within

Relative = Annotated[float, within(0, 0.5)]


@dataclass(frozen=True)
class Component:
    """A source of uncertainty.

    Attributes
    ----------
    name
        In `samples.nc` it is the variable `sigma_<name>`.
    common
        Whether all samples of a session share the error; otherwise each has one of its own.
    meaning
        One line.
    """

    name: str
    common: bool
    meaning: str


COMPONENTS: Final = (
    Component("photon", False, "photon noise of the sample's frames"),
    Component("read", False, "read noise of the sample's frames"),
    Component("dark", True, "noise of the mean dark frames; drift of the black level"),
    Component("white", True, "noise and flux of the white frames"),
    Component("calibration", True, "flat field, linearity and lamps as gonio calibrate found them"),
    Component("color", True, "the light's color, the camera's matrix, and what lamps drift"),
    Component("shutter", True, "how long the shutter is open, exposure by exposure"),
    Component("flux", False, "the lamps' flux monitor, frame by frame"),
    Component("angle", True, "zero of each axis, through the slope of the BRDF and the cosine"),
    Component("alignment", True, "tilt and height of the sample, and of the reference"),
    Component("stray", True, "the share of stray light"),
    Component("reference", True, "the reference's own BRDF"),
)
"""All of them; their squares add up to that of sigma."""

COMPONENT_NAMES: Final = tuple(component.name for component in COMPONENTS)


class Uncertainty(Document):
    """Standard uncertainties that no frame tells, `[uncertainty]` in a rig file; 0 is not stated.

    Attributes
    ----------
    reference
        Of the white reference's BRDF, relative.
    flux_monitor
        Of the lamps' measured flux from frame to frame, relative.
    shutter
        Of the times of exposure that files state, each exposure's by itself, relative.
    lamp_color
        By how much lamps' colors change against each other, relative, for each unit of relative
        change of their flux since the white frames.
    angle_deg
        Of the zero of each axis.
    tilt_deg
        Of the sample's plane, about each of its edges; anew for the reference.
    height_mm
        Of the sample's face over the axes' common centre; anew for the reference.
    black_level_dn
        Of the black level, in raw units: by how much it drifts after the dark frames.
    stray_light
        Of `[camera] stray_light`, as a share as that is.
    """

    reference: Relative = 0.0
    flux_monitor: Relative = 0.0
    shutter: Relative = Field(default=0.0, exclude_if=lambda it: not it)
    lamp_color: Annotated[float, within(0, 5)] = Field(default=0.0, exclude_if=lambda it: not it)
    angle_deg: Annotated[float, within(0, 1)] = 0.0
    tilt_deg: Annotated[float, within(0, 1)] = 0.0
    height_mm: Annotated[float, within(0, 5)] = 0.0
    black_level_dn: Annotated[float, within(0, 1000)] = 0.0
    stray_light: Relative = 0.0
