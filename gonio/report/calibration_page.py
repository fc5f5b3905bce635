"""The page of a calibration: what was found of the camera, and what it was told from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.files import write_bytes
from gonio.report import calibration_drawings as draw
from gonio.report.drawings import Drawing
from gonio.report.figures import inline_svg, page_style
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from gonio.calibration import CalibrationDocument

PAGE_NAME = "calibration.html"


def write_calibration_page(
    folder: Path,
    document: CalibrationDocument,
    maps: Path,
    compared: Sequence[tuple[str, str, str]],
) -> None:
    """Write `calibration.html`, self-contained.

    Parameters
    ----------
    folder
        Where it goes.
    document
        What was found.
    maps
        The file of each pixel's offset, dark current and response.
    compared
        Of the twin alone: name, found, injected.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("gonio", "report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    page = environment.get_template("calibration.html").render(
        document=document,
        cards=list(_cards(document)),
        compared=compared,
        curves=list(_curves(document)),
        maps=list(_maps(document, maps)),
    )
    write_bytes(folder / PAGE_NAME, page.encode("utf-8", "backslashreplace"))


def _cards(document: CalibrationDocument) -> Iterator[tuple[str, str, str]]:
    """Yield name, value and note of the figures that are looked for first."""
    bad = document.bad_pixels
    yield (
        "Gain", f"{document.gain:.4f}", f"raw units per electron, +- {document.gain_sigma:.4f}"
    )  # fmt: skip
    yield "Read noise", f"{document.read_noise_e:.2f}", "electrons"
    yield "Full well", f"{document.full_well_e:.0f}", "electrons, where the raw values end"
    linearity = document.linearity
    yield (
        "Nonlinearity", f"{100 * linearity.deviation:.2f} %",
        f"off the best line at most, {100 * linearity.left:.2f} % when corrected; known up to "
        f"{100 * min(linearity.reach, 1.0):.0f} % of the range",
    )  # fmt: skip
    yield (
        "Bad pixels", str(sum(count for _, count in bad)),
        ", ".join(f"{count} {name}" for name, count in bad),
    )  # fmt: skip


def _curves(document: CalibrationDocument) -> Iterator[Drawing]:
    levels = several(len(document.transfer), "level")
    with page_style():
        yield _drawing(
            "Photon transfer", draw.draw_transfer(document),
            f"Variance of a green pixel from frame to frame against its signal, {levels} of the "
            "white reference; the line is gain x signal + read variance.",
        )  # fmt: skip
        yield _drawing(
            "Linearity", draw.draw_linearity(document),
            "How far the signal is from a line, before (open) and after the correction (filled).",
        )  # fmt: skip
        yield _drawing(
            "Dark level", draw.draw_dark(document),
            "Mean above BlackLevel for a second of exposure, against the time since the first "
            "frame: a sensor in use warms up.",
        )  # fmt: skip
        yield _drawing(
            "Lamps", draw.draw_lamps(document),
            "What each lamp sheds for its monitor's reading, against the mean; bars of two sigma.",
        )  # fmt: skip


def _maps(document: CalibrationDocument, path: Path) -> Iterator[Drawing]:
    share = 100 * document.flat_covered
    with np.load(path, allow_pickle=False) as maps, page_style():
        yield _drawing(
            "Flat field", draw.draw_field(maps["response"], "response, 1 at the centre"),
            f"Measured for {share:.0f} % of the pixels, by a smooth fit for the others.",
        )  # fmt: skip
        rate = maps["rate"] / document.gain
        yield _drawing(
            "Dark current", draw.draw_field(rate, "electrons a second", maps["bad"]),
            "Bad pixels are circled.",
        )  # fmt: skip


def _drawing(title: str, figure: Figure, caption: str) -> Drawing:
    name = "-".join(title.lower().split())
    return Drawing(title, inline_svg(figure, name, f"{title}: {caption}"), caption)
