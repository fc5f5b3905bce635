"""How well matrices fit measured cameras, and how well they serve when lamps change: `make color`.

Cameras are those whose spectral sensitivities colour-science holds (measured at the National
Physical Laboratory), lamps its CIE illuminants, patches its mean of thirty measured charts.
"""

from __future__ import annotations

from functools import partial

import click
import numpy as np

from gonio.chart import published_xyz
from gonio.color import D65, XYZ_FROM_SRGB
from gonio.colorimetry.difference import delta_e_2000
from gonio.colorimetry.matrix import fit_matrix
from gonio.colorimetry.spectra import colour_science, lit_xyz, measured_charts, wavelengths_nm
from gonio.reduce.balance import balance
from gonio.reduce.color import Coloring

LAMPS = ("D65", "A", "LED-B3", "LED-V1", "LED-RGB1")
ROOTS = ((0, 1), (1, 2), (0, 2))
SRGB = np.linalg.inv(XYZ_FROM_SRGB)


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


def changes(nm):
    """Return what lamps may do as they warm up or age, relative, by wavelength."""
    return {
        "red fades by 4 %": 1.0 + np.interp(nm, [450, 550, 610], [0.012, 0.0, -0.04]),
        "5 % in 150 nm": 1.0 + 0.05 * (nm - 555.0) / 150.0,
        "blue peak fades by 5 %": 1.0 - 0.05 * np.exp(-(((nm - 450.0) / 15.0) ** 2)),
    }


def left_by_balances(camera_of, power, xyz, nm):
    """Return what balances leave of a change of light, in shares of their distance, shape (n, 3).

    By channels, by primaries, by half of each, and as gonio does; in linear sRGB, root mean squares
    over the patches.
    """
    before, white = camera_of(power)
    mixed = np.linalg.inv(SRGB @ fit_matrix(before / white, xyz))
    true, rows = before / white @ np.linalg.inv(mixed).T, []
    for change in changes(nm).values():
        now, white_now = camera_of(power * change)
        coloring = Coloring("sRGB", "test", mixed, np.eye(3), neutral=white)
        found = balance(coloring, white_now, np.ones(3))
        half = (found.by_channels + found.by_primaries) / 2.0
        models = found.by_channels, found.by_primaries, half, found.matrix
        values = [now / white_now @ each.T for each in models]
        apart = rms(values[1] - values[0])
        rows.append([rms(value - true) / apart for value in values])
    return np.array(rows)


def rms(of):
    return np.sqrt(np.mean(of**2))


def echo_balances(colour, nm, chart):
    """Print what each balance leaves, by camera and for all, mean squares over lamps."""
    found = {}
    for name, spectra in colour.MSDS_CAMERA_SENSITIVITIES.items():
        sensitivity = sampled(spectra, nm)

        def camera_of(power, sensitivity=sensitivity):
            weights = power[:, None] * sensitivity
            return chart.T @ weights, weights.sum(axis=0)

        found[name] = np.concatenate(
            [left_by_balances(camera_of, power, lit_xyz(power), nm) for power in lamps(colour, nm)]
        )
    found["both"] = np.concatenate(list(found.values()))
    click.echo(
        "left of a change of light: by channels, by primaries, by half of each, as gonio does"
    )
    for name, rows in found.items():
        click.echo(f"{name:20} " + " ".join(f"{share:.2f}" for share in map(rms, rows.T)))


def lamps(colour, nm):
    spectra = [colour.SDS_ILLUMINANTS[lamp] for lamp in LAMPS]
    return [np.interp(nm, light.wavelengths, light.values) for light in spectra]


def sampled(spectra, nm):
    return np.column_stack([np.interp(nm, spectra.wavelengths, each) for each in spectra.values.T])


def main():
    """Print a row for each camera under each lamp."""
    colour = colour_science()
    nm, chart = wavelengths_nm(), measured_charts(colour)
    echo_balances(colour, nm, chart)
    fits = {"kept": kept, "plain": plain, "root": partial(plain, terms=rooted)}
    click.echo("CIEDE2000: mean and largest of 24 patches, mean of each left out, and of white")
    for name, spectra in colour.MSDS_CAMERA_SENSITIVITIES.items():
        sensitivity = sampled(spectra, nm)
        for lamp, power in zip(LAMPS, lamps(colour, nm), strict=True):
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
