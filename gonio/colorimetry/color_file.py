"""What `gonio color` found, as a file: a camera's matrix for each set of lamps, and how good."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Final, Literal

import numpy as np
from pydantic import Field

from gonio.calibration import CameraIdentity
from gonio.errors import BadInputError
from gonio.ofrig import OfRig
from gonio.validation import Document, within
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import NDArray


SCHEMA: Final = "gonio.color/1"

Number = Annotated[float, within(-1e9, 1e9)]
Three = tuple[Number, Number, Number]
Matrix = tuple[Three, Three, Three]


class PatchColor(Document):
    """One patch of the chart.

    Attributes
    ----------
    name
        Its name.
    camera, sigma
        Reflectance factor in white-balanced camera RGB, and its noise.
    reference, found
        XYZ under D65, a perfect diffuser's Y being 1: what it is known to be, and by the matrix.
    delta_e
        CIEDE2000 of the two.
    """

    name: str
    camera: Three
    sigma: Three
    reference: Three
    found: Three
    delta_e: Number


class ChartMatrix(Document):
    """What a chart told under one set of lamps.

    Attributes
    ----------
    lamps
        Their numbers.
    xyz_from_camera
        White-balanced camera RGB to XYZ under D65; it maps (1, 1, 1) to D65's white.
    white
        What the channels, not balanced, say of white under these lamps, green's as 1. Files of
        before tell neither this nor `errors`.
    errors
        Of `xyz_from_camera`, such as occur independently, one standard uncertainty each.
    reference
        Where the patches' colors are from, in words, with the SHA-256 of files.
    frames_sha256
        Of the journal's records of all frames used.
    patches
        All, row by row.
    """

    lamps: tuple[int, ...]
    xyz_from_camera: Matrix
    white: Three | None = Field(default=None, exclude_if=lambda it: it is None)
    errors: tuple[Matrix, ...] = Field(default=(), exclude_if=lambda it: not it)
    reference: str
    frames_sha256: str
    patches: tuple[PatchColor, ...]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """`xyz_from_camera`, shape (3, 3)."""
        return np.array(self.xyz_from_camera)

    @property
    def delta_e(self) -> NDArray[np.float64]:
        """CIEDE2000 of all patches, shape (24,)."""
        return np.array([patch.delta_e for patch in self.patches])


class ColorFile(OfRig):
    """The matrices of a camera on its rig.

    Attributes
    ----------
    rig_sha256, camera
        What the chart was shot with.
    adaptation
        How colors under other whites came to D65.
    charts
        One for each set of lamps.
    """

    remedy: ClassVar[str] = "make it anew with: gonio color SESSION"

    schema_: Literal["gonio.color/1"] = Field(default=SCHEMA, alias="schema")
    camera: CameraIdentity
    adaptation: Literal["Bradford to D65"] = "Bradford to D65"
    charts: tuple[ChartMatrix, ...] = Field(min_length=1)

    def under(self, lamps: Collection[int]) -> ChartMatrix:
        """Return the matrix for a set of lamps; one that is alone serves all.

        Raises
        ------
        gonio.errors.BadInputError
            When there are several, and none is of this set.
        """
        if len(self.charts) == 1:
            return self.charts[0]
        for chart in self.charts:
            if set(chart.lamps) == set(lamps):
                return chart
        known = "; ".join(_listed(chart.lamps) for chart in self.charts)
        raise BadInputError(
            f"the color file has a matrix for lamps {known}, and none for {_listed(lamps)}, which "
            "this session lit; shoot the chart under these, and give its session to gonio color, "
            "too"
        )


def lit_lamps(lamps_of_shots: Collection[Collection[int]]) -> tuple[int, ...]:
    """Return the lamps that all shots of a session lit alike.

    Raises
    ------
    gonio.errors.BadInputError
        When they differ: lamps of different spectra want a session, and white frames, for each.
    """
    sets = {frozenset(lamps) for lamps in lamps_of_shots}
    if len(sets) > 1:
        raise BadInputError(
            f"the shots were lit by {several(len(sets), 'set')} of lamps, and a matrix is for one; "
            "measure each set in a session of its own"
        )
    return tuple(sorted(next(iter(sets), frozenset())))


def _listed(lamps: Collection[int]) -> str:
    return ", ".join(map(str, sorted(lamps)))
