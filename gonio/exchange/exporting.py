"""Writing a material for another program, and saying what that keeps and loses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.exchange.isotropy import ISOTROPIC_BELOW
from nnbrdf.metrics import eps8, male

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.exchange.format import Format, Source
    from gonio.protocols import Progress

_LINEAR = ("linear sRGB", "luminance")


@dataclass(frozen=True)
class Exported:
    """A file that was written, and how near it is to what was to be written.

    Attributes
    ----------
    format
        Of the file.
    eps8, male
        Errors of the file, read back, at the 81 x 81 pairs (see `nnbrdf.metrics`); None where
        gonio does not read the format.
    notes
        What this material loses in this format, a line each.
    """

    format: Format
    eps8: float | None
    male: float | None
    notes: tuple[str, ...]


def export(
    source: Source, format_: Format, path: Path, progress: Progress | None = None
) -> Exported:
    """Write a material and read it back.

    Raises
    ------
    gonio.errors.BadInputError
        When the format cannot hold such a material.
    gonio.errors.StorageError
        When the file cannot be written.
    """
    if format_.write is None:
        raise BadInputError(f"gonio reads {format_.name}, but does not write it; use another --to")
    if not format_.anisotropic and source.anisotropy > ISOTROPIC_BELOW:
        raise BadInputError(
            f"{source.name} changes by {source.anisotropy:.0%} when it is turned, and "
            f"{format_.name} holds isotropic materials only; add --isotropic to write the mean "
            "over all turns, or use another --to"
        )
    format_.write(source, path, progress)
    eps8_, male_ = _errors(source, format_, path)
    return Exported(format_, eps8_, male_, tuple(_notes(source, format_)))


def _errors(source: Source, format_: Format, path: Path) -> tuple[float, float] | tuple[None, None]:
    if format_.read is None:
        return None, None
    directions = paper_directions()
    back = format_.read(path).evaluate(directions[:, None], directions)
    return eps8(back, source.values, source.white), male(back, source.values, source.white)


def _notes(source: Source, format_: Format) -> list[str]:
    notes = []
    if source.uncertain is not None and not format_.sigma:
        notes.append(f"its sigma is not in the file: {format_.name} has no place for it")
    if source.color_space not in _LINEAR:
        notes.append(f"its colours are {source.color_space}, which readers take for linear sRGB")
    return notes
