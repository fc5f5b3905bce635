"""From sessions of a chart to the file of the camera's matrices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.chart import patch_names, published_xyz
from gonio.cli._console import progress_bar
from gonio.colorimetry.color_file import ChartMatrix, ColorFile, PatchColor
from gonio.colorimetry.difference import delta_e_2000
from gonio.colorimetry.matrix import fit_matrix, matrix_errors
from gonio.errors import BadInputError
from gonio.files import sha256_file
from gonio.reduce.chart import read_chart
from gonio.report.color_chart import write_color_chart
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.colorimetry.color_file import Matrix, Three
    from gonio.reduce.chart import ChartReading, Corners
    from gonio.session import Session

_NO_CHART = 12.0
"""CIEDE2000 in the median beyond which no camera is so odd: the patches are others."""


def color_of(
    sessions: Sequence[Session],
    lamps: Sequence[Path],
    chart: Path | None,
    corners_px: Corners | None,
    picture: Path,
) -> ColorFile:
    """Read each session's chart, fit its matrix, and draw the first.

    Raises
    ------
    gonio.errors.BadInputError
        When a chart cannot be read or is none, or sessions are of different rigs or cameras.
    """
    _refuse(sessions, lamps, chart)
    readings, charts = [], []
    for number, session in enumerate(sessions):
        lamp = lamps[min(number, len(lamps) - 1)] if lamps else None
        with session.lock(), progress_bar("reading the chart") as progress:
            reading = read_chart(session, corners_px, progress)
        readings.append(reading)
        charts.append(_matrix_of(reading, session, *_reference(lamp, chart)))
    cameras = {reading.raw.sensor.identity for reading in readings}
    sets = [each.lamps for each in charts]
    if len(cameras) > 1 or len(set(sets)) < len(sets):
        raise BadInputError(
            "the sessions are of different cameras, or two of the same lamps; name one session for "
            "each set of lamps, all of one camera"
        )
    first = readings[0]
    write_color_chart(picture, first.raw, first.homography, charts[0])
    return ColorFile(
        rig_sha256=sessions[0].rig().sha256, camera=cameras.pop(), charts=tuple(charts)
    )


def _refuse(sessions: Sequence[Session], lamps: Sequence[Path], chart: Path | None) -> None:
    if chart and not lamps:
        raise BadInputError("--chart are spectra, which need a lamp's; name it with --lamp")
    if lamps and len(lamps) not in (1, len(sessions)):
        raise BadInputError(
            f"--lamp is there {len(lamps)} times for {several(len(sessions), 'session')}; name it "
            "once, or once for each"
        )
    if len({session.rig().sha256 for session in sessions}) > 1:
        raise BadInputError("the sessions are of different rigs; a matrix is of one")


def _reference(lamp: Path | None, chart: Path | None) -> tuple[NDArray[np.float64], str]:
    """Return XYZ of the patches, shape (24, 3), and where that is from."""
    if lamp is None:
        return published_xyz(), "published values"
    from gonio.colorimetry.spectra import lit_xyz, read_chart_spectra, read_lamp

    power, spectra = read_lamp(lamp), read_chart_spectra(chart) if chart else None
    on = f"chart {sha256_file(chart)[:12]}" if chart else "measured charts"
    return lit_xyz(power, spectra), f"lamp {sha256_file(lamp)[:12]} on {on}"


def _matrix_of(
    reading: ChartReading, session: Session, reference: NDArray[np.float64], source: str
) -> ChartMatrix:
    matrix = fit_matrix(reading.factor, reference)
    found = reading.factor @ matrix.T
    delta_e = delta_e_2000(found, reference)
    if np.median(delta_e) > _NO_CHART:
        raise BadInputError(
            f"{session.root}: the patches are no such chart (CIEDE2000 {np.median(delta_e):.0f} in "
            "the median); check the chart, --corners and their order, and the lamps' spectrum"
        )
    columns = (reading.factor, reading.sigma, reference, found)
    rows = zip(patch_names(), *(each.tolist() for each in columns), delta_e.tolist(), strict=True)
    names = ("name", "camera", "sigma", "reference", "found", "delta_e")
    return ChartMatrix(
        lamps=reading.lamps,
        xyz_from_camera=_plain(matrix),
        white=_three(reading.white),
        errors=tuple(map(_plain, matrix_errors(reading.factor, reference, reading.white_sigma))),
        reference=source,
        frames_sha256=reading.frames_sha256,
        patches=tuple(
            PatchColor.model_validate(dict(zip(names, row, strict=True))) for row in rows
        ),
    )


def _plain(matrix: NDArray[np.float64]) -> Matrix:
    first, second, third = map(_three, matrix)
    return first, second, third


def _three(numbers: NDArray[np.float64]) -> Three:
    first, second, third = numbers.tolist()
    return first, second, third
