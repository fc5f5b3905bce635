"""A calibration as a dated folder, every file hashed: read, judged, and kept in a session."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gonio.calibration import DOCUMENT_NAME, MAPS_NAME, CalibrationDocument
from gonio.errors import BadFileError, BadInputError
from gonio.files import sha256_file, write_bytes
from gonio.validation import check, parse_json, read_text

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

    from gonio.calibration import TwinIdentity
    from gonio.session import Session

DEFAULT_MAX_AGE_DAYS: Final = 30.0

_REMEDY = "calibrate anew with: gonio calibrate"
_DAY_S = 86400.0
# clocks of two machines may differ by so many days
_MOST_AHEAD_DAYS = 1.0


def load_calibration(folder: Path, *, whole: bool = True) -> CalibrationDocument:
    """Read the document of a folder, and check that nothing in it has changed since.

    Parameters
    ----------
    folder
        As `gonio calibrate` wrote it.
    whole
        Whether its frames have to be there, too; the copy in a session has none.

    Raises
    ------
    gonio.errors.BadFileError
        When the document or a file that it names is missing or has changed.
    """
    path = folder / DOCUMENT_NAME
    data = parse_json(read_text(path, _REMEDY), path, _REMEDY)
    stated = data.pop("sha256", None) if isinstance(data, dict) else None
    document = check(CalibrationDocument, data, path, _REMEDY)
    if document.sha256 != stated:
        raise BadFileError(path, "has changed since it was written (its SHA-256 differs)", _REMEDY)
    for name in document.files if whole else (MAPS_NAME,):
        _check_file(folder / name, document.files.get(name))
    return document


def _check_file(path: Path, sha256: str | None) -> None:
    if not path.is_file():
        raise BadFileError(path, "is missing from the calibration", _REMEDY)
    if sha256_file(path) != sha256:
        raise BadFileError(path, "has changed since the calibration", _REMEDY)


def check_usable(
    document: CalibrationDocument,
    folder: Path,
    rig_sha256: str,
    twin: TwinIdentity | None,
    now: datetime,
    max_age_days: float,
) -> None:
    """Refuse a calibration of another rig or camera, or one that is too old.

    Parameters
    ----------
    document, folder
        The calibration, and where it lies.
    rig_sha256, twin
        What is to be measured with.
    now
        By the clock of the capture.
    max_age_days
        How old it may be.

    Raises
    ------
    gonio.errors.BadInputError
        Saying what differs.
    """
    if document.rig_sha256 != rig_sha256:
        raise BadInputError(
            f"{folder}: was made on another rig ({document.rig_sha256[:12]}, not "
            f"{rig_sha256[:12]}); calibrate this one with gonio calibrate, or name that rig"
        )
    if document.twin != twin:
        raise BadInputError(
            f"{folder}: was made with another camera ({_named(document.twin)}, not "
            f"{_named(twin)}); calibrate this one with gonio calibrate"
        )
    age_days = (now - document.made_utc).total_seconds() / _DAY_S
    if age_days < -_MOST_AHEAD_DAYS:
        raise BadInputError(
            f"{folder}: is dated {-age_days:.1f} days after now; set the clock right, or calibrate "
            "anew with gonio calibrate"
        )
    # a number that is none allows nothing
    if not age_days <= max_age_days:
        raise BadInputError(
            f"{folder}: is {age_days:.1f} days old, and {max_age_days:g} are allowed; calibrate "
            "anew with gonio calibrate, or allow more with --max-age"
        )


def _named(twin: TwinIdentity | None) -> str:
    if twin is None:
        return "a real one"
    return f"the twin's of seed {twin.seed}, imperfections {twin.imperfections_sha256[:8]}"


def keep_calibration(session: Session, folder: Path, document: CalibrationDocument) -> None:
    """Copy document and maps of a calibration into a new session; its frames stay where they are.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses.
    """
    write_bytes(session.sensor_calibration / MAPS_NAME, (folder / MAPS_NAME).read_bytes())
    document.save(session.sensor_calibration)


def kept_calibration(session: Session) -> CalibrationDocument | None:
    """Return the calibration of a session, None where it has none (errors as the loader's)."""
    if not session.sensor_calibration.is_dir():
        return None
    return load_calibration(session.sensor_calibration, whole=False)
