"""Writing a calibration down: its document and its maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.calibration import MAPS_NAME, CalibrationDocument
from gonio.files import sha256_file, write_with

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

    from gonio.calibrate.findings import Findings
    from gonio.calibration import TwinIdentity


def document_of(
    findings: Findings, made_utc: datetime, twin: TwinIdentity | None
) -> CalibrationDocument:
    """Return the document of what was found, which names no files yet."""
    return CalibrationDocument(
        made_utc=made_utc,
        rig_sha256=findings.rig.sha256,
        camera=findings.sensor.identity,
        twin=twin,
        gain=findings.gain,
        gain_sigma=findings.gain_sigma,
        read_noise_e=findings.read_noise_e,
        saturation=findings.end.saturation,
        end_seen=findings.end.seen,
        full_well_e=findings.full_well_e,
        linearity=findings.linearity,
        transfer=tuple(findings.points),
        dark=findings.series,
        lamps=tuple(findings.lamps),
        bad_pixels=findings.bad_pixels,
        flat_covered=float(findings.measured.mean()),
        flat_sigma=findings.flat_sigma,
        stray_light=findings.stray_light,
        files={},
    )


def write_maps(findings: Findings, folder: Path) -> None:
    """Write each pixel's offset, dark current, response and whether it is bad."""

    def write(aside: Path) -> None:
        with aside.open("wb") as file:
            np.savez_compressed(
                file,
                offset=findings.dark.offset.astype(np.float32),
                rate=findings.dark.rate.astype(np.float32),
                response=findings.response.astype(np.float32),
                bad=findings.bad,
            )

    write_with(folder / MAPS_NAME, write)


def seal(document: CalibrationDocument, folder: Path) -> CalibrationDocument:
    """Write the document with the SHA-256 of every file that lies in the folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    hashes = {str(path.relative_to(folder)): sha256_file(path) for path in files}
    sealed = document.model_copy(update={"files": hashes})
    sealed.save(folder)
    return sealed
