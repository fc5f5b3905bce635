"""How well matrices fit measured cameras, by patch and left out; run by `make color`.

Cameras are those whose spectral sensitivities colour-science holds (measured at the National
Physical Laboratory), lamps its CIE illuminants, patches its mean of thirty measured charts.
"""

from __future__ import annotations

from functools import partial

import click
import numpy as np

from gonio.chart import published_xyz
from gonio.color import D65
from gonio.colorimetry.difference import delta_e_2000
from gonio.colorimetry.matrix import fit_matrix
from gonio.colorimetry.spectra import colour_science, lit_xyz, measured_charts, wavelengths_nm

LAMPS = ("D65", "A", "LED-B3", "LED-V1", "LED-RGB1")
ROOTS = ((0, 1), (1, 2), (0, 2))


def rooted(camera):
    """Return the channels and the roots of their products (Finlayson et al. 2015)."""
    products = [np.sqrt(camera[:, i] * camera[:, j]) for i, j in ROOTS]
    return np.column_stack([camera, *products])


def plain(camera, xyz, terms=np.asarray):
    """Fit by unweighted least squares in XYZ, white as it comes; return what maps channels."""
    matrix = np.linalg.lstsq(terms(camera), xyz, rcond=None)[0]
    return lambda channels: terms(channels) @ matrix


def kept(camera, xyz):
    """Fit as gonio does."""
    matrix = fit_matrix(camera, xyz)
    return lambda channels: channels @ matrix.T


def left_out(fit, camera, xyz):
    """Return the mean difference of each patch by a fit to the others."""
    others = [np.arange(len(xyz)) != patch for patch in range(len(xyz))]
    found = [fit(camera[o], xyz[o])(camera[~o])[0] for o in others]
    return delta_e_2000(np.array(found), xyz).mean()


def main():
    """Print a row for each camera under each lamp."""
    colour = colour_science()
    nm, chart = wavelengths_nm(), measured_charts(colour)
    fits = {"kept": kept, "plain": plain, "root": partial(plain, terms=rooted)}
    click.echo("CIEDE2000: mean and largest of 24 patches, mean of each left out, and of white")
    for name, spectra in colour.MSDS_CAMERA_SENSITIVITIES.items():
        sensitivity = np.column_stack(
            [np.interp(nm, spectra.wavelengths, each) for each in spectra.values.T]
        )
        for lamp in LAMPS:
            light = colour.SDS_ILLUMINANTS[lamp]
            power = np.interp(nm, light.wavelengths, light.values)
            weights = power[:, None] * sensitivity
            camera, xyz = chart.T @ (weights / weights.sum(axis=0)), lit_xyz(power)
            row = []
            for fit in fits.values():
                by = fit(camera, xyz)
                off = delta_e_2000(by(camera), xyz)
                white = delta_e_2000(by(np.ones((1, 3))), D65[None])[0]
                loo = left_out(fit, camera, xyz)
                row.append(f"{off.mean():.2f} {off.max():.2f} {loo:.2f} {white:.2f}")
            blind = delta_e_2000(kept(camera, published_xyz())(camera), xyz).mean()
            texts = "  ".join(f"{n}: {r}" for n, r in zip(fits, row, strict=True))
            click.echo(f"{name:20} {lamp:9} {texts}  published: {blind:.2f}")


if __name__ == "__main__":
    main()
