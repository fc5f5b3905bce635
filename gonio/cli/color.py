"""`gonio color`: the camera's color matrix, by shots of a chart of 24 patches."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answer, answers

if TYPE_CHECKING:
    from rich.table import Table

    from gonio.colorimetry.color_file import ChartMatrix, ColorFile
    from gonio.session import Session


@click.command(name="color")
@click.argument("roots", metavar="[SESSION]...", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--lamp",
    "lamps",
    metavar="CSV",
    multiple=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="Spectrum of the lamps, columns wavelength_nm and power: the patches are then what they "
    "are in its light. Once for all sessions, or once for each.",
)
@click.option(
    "--chart",
    "chart",
    metavar="CSV",
    type=click.Path(dir_okay=False, path_type=Path),
    help="With --lamp: reflectance of your chart, wavelength_nm and 24 columns, dark skin to black."
    "  [default: the mean of thirty measured charts]",
)
@click.option(
    "--corners",
    metavar="'X,Y X,Y X,Y X,Y'",
    help="Where in the frame the middles of dark skin, bluish green, black and white are, in "
    "pixels, for a chart that is not found by itself.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("color.json"),
    show_default=True,
    help="The file of what was found, and a picture of the same name; replaced where they are.",
)
@answers
def command(
    *,
    roots: tuple[Path, ...],
    lamps: tuple[Path, ...],
    chart: Path | None,
    corners: str | None,
    output: Path,
) -> None:
    """Find the matrix from the camera's channels to XYZ from a chart in SESSION's shots.

    Lay a chart of 24 patches (ColorChecker Classic's layout) in the holder instead of a sample and
    shoot it from above, lit at 45 deg. Each patch's color by the matrix is compared with what it
    should be (CIEDE2000). Where lamps differ in spectrum, measure the chart once in a session of
    each, and name them all. Of a twin the true matrix is compared with the one found.

    \b
    Examples:
        gonio plan --view-candidates rings:0x1 --light-candidates rings:45x4 \\
            --density all -o chart.json
        gonio capture --sim --material colorchecker --plan chart.json -o chart/
        gonio color chart/
        gonio color chart/ --lamp led.csv --chart mine.csv
        gonio reduce session/ --color color.json --space xyz
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.cli._color import color_of
    from gonio.cli._console import console
    from gonio.session import Session

    sessions = [Session.open(root) for root in roots or (Path("chart"),)]
    found = color_of(sessions, lamps, chart, _corners(corners), output.with_suffix(".png"))
    found.save(output)
    for matrix in found.charts:
        console.print(_table(matrix))
        console.print(_summary(matrix))
    off = _off_true(sessions[0], found)
    if off is not None:
        console.print(f"of the twin's own matrix, no element is off by more than {off:.4f}")
    console.print(f"color: {output}, picture: {output.with_suffix('.png')}")
    answer(
        {
            "file": output,
            "picture": output.with_suffix(".png"),
            "largest_off_true": off,
            **found.model_dump(mode="json", exclude={"schema_"}),
        }
    )


def _corners(text: str | None) -> tuple[tuple[float, float], ...] | None:
    import numpy as np

    from gonio.errors import BadInputError
    from gonio.validation import plain_float

    if text is None:
        return None
    try:
        pairs = [tuple(map(plain_float, pair.split(","))) for pair in text.split()]
    except ValueError:
        pairs = []
    if [len(pair) for pair in pairs] != [2] * 4 or not np.isfinite(pairs).all():
        raise BadInputError(
            f"--corners {text!r}: four pairs of column and row are needed, such as '25,45 25,155 "
            "91,155 91,45'"
        )
    return tuple((pair[0], pair[1]) for pair in pairs)


def _table(matrix: ChartMatrix) -> Table:
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0))
    for title in ("patch", "X", "Y", "Z", "off", "delta E"):
        table.add_column(title, justify="left" if title == "patch" else "right")
    for patch in matrix.patches:
        off = max(abs(f - r) for f, r in zip(patch.found, patch.reference, strict=True))
        numbers = (f"{each:.4f}" for each in (*patch.reference, off))
        table.add_row(patch.name, *numbers, f"{patch.delta_e:.2f}")
    return table


def _summary(matrix: ChartMatrix) -> str:
    from gonio.words import several

    delta_e = matrix.delta_e
    return (
        f"{several(len(matrix.lamps), 'lamp')}, {matrix.reference}: CIEDE2000 of 24 patches "
        f"{delta_e.mean():.2f} in the mean, {delta_e.max():.2f} at most"
    )


def _off_true(session: Session, found: ColorFile) -> float | None:
    """Return how far the matrix is from the one that the session's twin was made with."""
    if not session.sim.is_dir():
        return None
    import numpy as np

    from gonio.color import XYZ_FROM_SRGB
    from sim.sensor import CAMERA_FROM_SRGB, CAMERA_NEUTRAL

    true = XYZ_FROM_SRGB @ np.linalg.inv(CAMERA_FROM_SRGB / CAMERA_NEUTRAL[:, None])
    return float(np.abs(found.charts[0].matrix - true).max())
