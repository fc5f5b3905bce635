"""What a calibration of the twin found, beside what the twin was made with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim import sensor
from sim.optics.vignetting import natural_falloff, optical_falloff
from sim.pixels.dark_current import AMBIENT_C, dark_rate
from sim.pixels.fixed_pattern import FixedPattern
from sim.pixels.full_well import gathered

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.calibrate.findings import Findings
    from gonio.rig import CameraSpec
    from sim.camera_imperfections import CameraImperfections

Row = tuple[str, str, str]
"""Name, found, injected."""

# a pixel with so many times the dark current of the others is hot whatever the noise
_CLEARLY_HOT = 20.0


def against_injected(findings: Findings, seed: int, sizes: CameraImperfections) -> list[Row]:
    """Return the quantities of a twin's sensor as they were recovered and as they are."""
    spec = findings.rig.camera
    pattern = FixedPattern.of((spec.height, spec.width), sizes, seed)
    end = sizes.camera_end
    full_e = _inverse(end, sizes.camera_full_well)
    true_bend = 0.9 * end * sensor.FULL_WELL_E / _inverse(0.9 * end, sizes.camera_full_well)
    linearity = findings.linearity
    found_bend = 1.0 / float(linearity.bending(np.array(0.9 * linearity.raw_range)))
    strengths = [lamp.strength for lamp in findings.lamps]
    return [
        ("gain, raw/e", f"{findings.gain:.4f} +- {findings.gain_sigma:.4f}", f"{sensor.GAIN:.4f}"),
        ("read noise, e", f"{findings.read_noise_e:.3f}", f"{sensor.READ_NOISE_E:.3f}"),
        ("full well, e", f"{findings.full_well_e:.0f}", f"{full_e:.0f}"),
        ("signal kept at 90 %", f"{found_bend:.4f}", f"{true_bend:.4f}"),
        _dark_row(findings, sizes),
        ("hot pixels", *_hot(findings, np.broadcast_to(pattern.dark, findings.bad.shape))),
        _flat_row(findings, pattern.response * _falloff(spec, sizes)),
        _stray_row(findings, sizes),
        _halo_row(findings, sizes),
        ("lamps' strengths", f"{min(strengths):.4f} to {max(strengths):.4f}", "1"),
    ]


def _inverse(fill: float, shortfall: float) -> float:
    """Return the electrons of which a pixel gathers `fill` of the full well."""
    electrons = np.linspace(0.0, 1.1 * sensor.FULL_WELL_E, 100_001)
    return float(np.interp(fill * sensor.FULL_WELL_E, gathered(electrons, shortfall), electrons))


def _dark_row(findings: Findings, sizes: CameraImperfections) -> Row:
    at, doubling = sizes.camera_dark_e_per_s, sizes.camera_dark_doubling_c
    rested, warm = (
        dark_rate(AMBIENT_C + rise_c, at, doubling) for rise_c in (0.0, sizes.camera_sensor_rise_c)
    )
    found = float(np.median(findings.dark.rate)) / findings.gain
    return "dark current, e/s", f"{found:.2f}", f"{rested:.2f} rested, {warm:.2f} warm"


def _hot(findings: Findings, dark: NDArray[np.float64]) -> tuple[str, str]:
    clearly, any_hot = dark > _CLEARLY_HOT, dark > 1.0
    found = int((findings.bad & clearly).sum())
    wrong = int((findings.bad & ~any_hot).sum())
    return (
        f"{found} of these, {int(findings.bad.sum())} in all, {wrong} of them good",
        f"{int(clearly.sum())} of over {_CLEARLY_HOT:g} x the dark current",
    )


def _flat_row(findings: Findings, true: NDArray[np.float64]) -> Row:
    middle = ~findings.bad & findings.measured
    ratio = findings.response[middle] / true[middle]
    left = float(np.std(ratio / np.median(ratio)))
    spread = float(np.std(true[middle]))
    return "flat field, relative sd", f"{100 * left:.3f} % left", f"{100 * spread:.3f} %"


def _stray_row(findings: Findings, sizes: CameraImperfections) -> Row:
    seen = findings.stray_light
    found = f"{100 * seen.share:.3f} % +- {100 * seen.sigma:.3f} %" if seen else "not seen"
    return "stray light", found, f"{100 * sizes.camera_glare:.3f} %"


def _halo_row(findings: Findings, sizes: CameraImperfections) -> Row:
    halo = findings.stray_light.halo if findings.stray_light else None
    found = f"{100 * halo.share:.2f} %, {halo.width:.3f} wide" if halo else "not seen"
    return "halo", found, f"{100 * sizes.camera_halo:.2f} %, {sizes.camera_halo_width:.3f} wide"


def _falloff(spec: CameraSpec, sizes: CameraImperfections) -> NDArray[np.float64]:
    falloff = optical_falloff(spec, sizes.camera_vignetting)
    return falloff * natural_falloff(spec) if sizes.camera_cos4 else falloff
