"""What `gonio geometry` found, as a file: camera, view arm, uncertainties and residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Final, Literal

import numpy as np
from pydantic import Field

from gonio.alignment import Alignment
from gonio.camera import Camera
from gonio.ofrig import OfRig
from gonio.photogrammetry.model import DISTORTION, INTRINSICS
from gonio.validation import Document, within

if TYPE_CHECKING:
    from gonio.photogrammetry.adjustment import Adjustment
    from gonio.rig import CameraSpec, Rig

SCHEMA: Final = "gonio.geometry/1"
LIMIT_DEG: Final = 0.03
LIMIT_MM: Final = 0.05

Positive = Annotated[float, within(0, 1e9)]


class Residuals(Document):
    """How well the views agree, as roots of mean squares.

    Attributes
    ----------
    views, corners
        How many counted.
    corner_px
        Of a corner, in one coordinate of the picture.
    corner_mm
        The same on the board, seen from above.
    angle_deg
        Of one axis in one view, against its encoder and the alignment.
    """

    views: int
    corners: int
    corner_px: Positive
    corner_mm: Positive
    angle_deg: Positive


class Geometry(OfRig):
    """Camera and view arm as measured; the light arm is not seen by the camera.

    Attributes
    ----------
    rig_sha256
        The rig that it is of.
    focal_px, centre_px, distortion
        As in the rig file.
    view
        The view arm's alignment.
    names, covariance
        Of the parameters, in the units that their names end in, shapes (n,) and (n, n).
    residuals
        What is left.
    """

    remedy: ClassVar[str] = "make it anew with: gonio geometry SESSION"

    schema_: Literal["gonio.geometry/1"] = Field(default=SCHEMA, alias="schema")
    focal_px: Positive
    centre_px: tuple[float, float]
    distortion: tuple[float, ...] = ()
    view: Alignment
    names: tuple[str, ...]
    covariance: tuple[tuple[float, ...], ...]
    residuals: Residuals

    @classmethod
    def of(cls, rig: Rig, found: Adjustment) -> Geometry:
        """Make the document of an adjustment."""
        spec = found.state.camera.spec
        off_deg = found.state.off_deg
        px = float(np.sqrt(np.mean(found.errors_px**2)))
        return cls(
            rig_sha256=rig.sha256,
            focal_px=spec.focal_px,
            centre_px=spec.centre_px,
            distortion=spec.distortion,
            view=Alignment.model_validate(found.state.alignment.model_dump()),
            names=found.names,
            covariance=tuple(map(tuple, found.covariance.tolist())),
            residuals=Residuals(
                views=len(off_deg),
                corners=len(found.errors_px),
                corner_px=px,
                corner_mm=px * 1000.0 * spec.distance_m / spec.focal_px,
                angle_deg=float(np.sqrt(np.mean(off_deg**2))),
            ),
        )

    @property
    def values(self) -> dict[str, float]:
        """Every parameter by its name."""
        intrinsics = dict(zip(INTRINSICS, (self.focal_px, *self.centre_px), strict=True))
        lens = dict(zip(DISTORTION, self.distortion, strict=False))
        return intrinsics | lens | self.view.model_dump()

    @property
    def sigmas(self) -> dict[str, float]:
        """One standard uncertainty of each."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    def camera(self, spec: CameraSpec) -> Camera:
        """Return the rig file's camera with what was found of it."""
        update = {name: getattr(self, name) for name in ("focal_px", "centre_px", "distortion")}
        return Camera(spec.model_copy(update=update))
