"""From the camera's channels to a color space: by its file's matrix, or by a chart's."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.color import CAMERA, SPACES, XYZ_FROM_SRGB, InSpace
from gonio.colorimetry.color_file import ColorFile, lit_lamps
from gonio.errors import BadFileError, BadInputError
from gonio.samples import RGB

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.plan import Shot
    from gonio.protocols import Material
    from gonio.reduce.raw import Sensor
    from gonio.session import Session

_NO_ERRORS: Final = np.zeros((0, 3, 3))

DEFAULT_SPACE: Final = "linear-srgb"
CHOICES: Final = (*SPACES, "camera")
"""What the command line takes."""


def camera_from_srgb(color_matrix: Sequence[float]) -> NDArray[np.float64]:
    """Return the matrix, shape (3, 3), from linear sRGB to white-balanced camera RGB.

    It is the file's matrix x `XYZ_FROM_SRGB`, each row scaled to a sum of one, so that a grey has
    equal channels on both sides.

    Parameters
    ----------
    color_matrix
        XYZ under D65 to camera, nine numbers row by row.

    Raises
    ------
    gonio.errors.BadInputError
        When there is none, or it cannot be inverted.
    """
    if not color_matrix:
        raise BadInputError(
            "the frames state no color matrix, so nothing tells their colors; give the file that "
            "gonio color makes of a chart with --color, or keep to --space camera"
        )
    camera = np.reshape(color_matrix, (3, 3)) @ XYZ_FROM_SRGB
    white = camera.sum(axis=1, keepdims=True)
    balanced: NDArray[np.float64] = camera / np.where(white > 0, white, np.nan)
    # past a hundred, noise would drown every color
    if not (np.isfinite(balanced).all() and np.linalg.cond(balanced) < 100.0):
        raise BadInputError(
            "the frames' color matrix does not tell colors apart; set the camera's matrix in its "
            "DNG files"
        )
    return balanced


def camera_of_white(color_matrix: Sequence[float]) -> NDArray[np.float64]:
    """Return `camera_from_srgb`, or what serves for near whites where frames state no matrix.

    Every channel then sees luminance.
    """
    return camera_from_srgb(color_matrix) if color_matrix else np.tile(XYZ_FROM_SRGB[1], (3, 1))


@dataclass(frozen=True)
class Coloring:
    """How camera channels become those of a space.

    Attributes
    ----------
    space
        As files state it.
    made_by
        `chart`, the frames' own, such as `ColorMatrix1`, or, of the camera's channels, `none`.
    camera_from_space, space_from_srgb
        Between white-balanced camera RGB, the space and linear sRGB, shape (3, 3).
    channels
        Their names.
    neutral
        What the channels, not balanced, say of white in the light that the matrix was made for, up
        to one factor, shape (3,); None where nothing tells.
    errors
        Of the matrix from camera channels to the space, such as occur independently, one standard
        uncertainty each, shape (n, 3, 3).
    """

    space: str
    made_by: str
    camera_from_space: NDArray[np.float64]
    space_from_srgb: NDArray[np.float64]
    channels: tuple[str, ...] = RGB
    neutral: NDArray[np.float64] | None = None
    errors: NDArray[np.float64] = field(default_factory=lambda: _NO_ERRORS)

    @property
    def white(self) -> NDArray[np.float64]:
        """What a perfect diffuser's factor of one is in the space, shape (3,)."""
        return np.asarray(self.space_from_srgb.sum(axis=1))

    def shown(self, material: Material) -> Material:
        """Return a material of linear sRGB in the space."""
        return InSpace(material, self.space_from_srgb)


@dataclass(frozen=True)
class Wanted:
    """The space to reduce to, and what is known of the camera and the lamps.

    Attributes
    ----------
    space
        One of `CHOICES`.
    chart
        What a chart told, where there was one.
    lamps
        The numbers of those that the shots were lit by.
    """

    space: str = DEFAULT_SPACE
    chart: ColorFile | None = None
    lamps: tuple[int, ...] = ()

    def coloring(self, sensor: Sensor) -> Coloring:
        """Return how the channels of a sensor become the space.

        Raises
        ------
        gonio.errors.BadInputError
            When the chart was shot with another camera, there is neither a chart nor a matrix
            in the frames, or it does not tell colors apart.
        """
        if self.space == "camera":
            return Coloring(CAMERA, "none", np.eye(3), camera_of_white(sensor.color_matrix))
        return self._by_chart(sensor) if self.chart else self._by_file(sensor)

    def _by_file(self, sensor: Sensor) -> Coloring:
        to_camera = camera_from_srgb(sensor.color_matrix)
        unbalanced = np.reshape(sensor.color_matrix, (3, 3)) @ XYZ_FROM_SRGB
        neutral = unbalanced.sum(axis=1) if sensor.scaled else None
        return self._in_space(to_camera, sensor.matrix_name, neutral)

    def _by_chart(self, sensor: Sensor) -> Coloring:
        assert self.chart is not None
        shot, here = self.chart.camera, sensor.identity
        if (shot.model, shot.pattern) != (here.model, here.pattern):
            raise BadInputError(
                f"the chart was shot with camera {shot.model} {shot.pattern}, and this session "
                f"with {here.model} {here.pattern}; shoot the chart with this one"
            )
        found = self.chart.under(self.lamps)
        to_camera = np.linalg.inv(found.matrix) @ XYZ_FROM_SRGB
        neutral = None if found.white is None else np.array(found.white)
        return self._in_space(to_camera, "chart", neutral, np.reshape(found.errors, (-1, 3, 3)))

    def _in_space(
        self,
        to_camera: NDArray[np.float64],
        made_by: str,
        neutral: NDArray[np.float64] | None,
        xyz_errors: NDArray[np.float64] = _NO_ERRORS,
    ) -> Coloring:
        space = SPACES[self.space]
        return Coloring(
            space=space.name,
            made_by=made_by,
            camera_from_space=to_camera @ np.linalg.inv(space.from_srgb),
            space_from_srgb=space.from_srgb,
            channels=space.channels,
            neutral=neutral,
            errors=space.from_srgb @ np.linalg.inv(XYZ_FROM_SRGB) @ xyz_errors,
        )


def wanted_in(session: Session, space: str | None, shots: Sequence[Shot]) -> Wanted:
    """Return what a session is reduced to, by the color file that it keeps.

    Parameters
    ----------
    session, shots
        What was measured.
    space
        One of `CHOICES`; by default linear sRGB.

    Raises
    ------
    gonio.errors.BadInputError
        When the color file is broken or of another rig, or several sets of lamps want one each.
    """
    chart = kept_color(session)
    lamps: tuple[int, ...] = ()
    if chart is not None and len(chart.charts) > 1:
        lamps = lit_lamps([[lamp.n for lamp in shot.lamps] for shot in shots])
    return Wanted(space or DEFAULT_SPACE, chart, lamps)


def kept_color(session: Session) -> ColorFile | None:
    """Return the color file that a session was given; None where it has none.

    Raises
    ------
    gonio.errors.BadFileError
        When it is broken or of another rig.
    """
    if not session.color_path.is_file():
        return None
    return ColorFile.load(session.color_path, session.rig())


def keep_color(path: Path, session: Session) -> None:
    """Copy a color file into a session, which is reduced by it from then on.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, broken or of another rig.
    """
    if not path.is_file():
        raise BadFileError(path, "no such file", "make it with: gonio color SESSION")
    ColorFile.load(path, session.rig()).save(session.color_path)
