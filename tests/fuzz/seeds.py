"""Good files, as short as each format allows, for a fuzzer to begin with."""

import struct
from collections.abc import Callable

import numpy as np

from gonio.exchange import Source, klems, tensor_file
from gonio.exchange.format import Format
from gonio.exchange.tree import serialise
from gonio.exchange.window_xml import write_window


class Dim:
    """A small anisotropic material."""

    def evaluate(self, light, view):
        shape = np.broadcast_shapes(light.shape, view.shape)
        return np.broadcast_to(0.1 + 0.05 * light[..., :1] * view[..., :1] + 0.01, shape)


def sow(format_: Format, folder) -> None:
    """Write a format's seeds to a folder; fails where its own importer refuses one."""
    for name, write in _SHORT.get(format_.name, {"whole": _whole}).items():
        path = folder / f"{name}{format_.suffix}"
        write(format_, path)
        format_.read(path)


def _whole(format_: Format, path) -> None:
    format_.write(Source(Dim(), "dim"), path, None)


def _merl(_: Format, path) -> None:
    planes = np.linspace(0.0, 90.0, 3 * 3 * 2 * 4)
    planes[5] = -1.0  # below the horizon
    path.write_bytes(struct.pack("<3i", 3, 2, 4) + planes.astype("<f8").tobytes())


def _tensor(azimuths: int, colours: str) -> Callable[[Format, object], None]:
    def write(_: Format, path) -> None:
        lights = (azimuths, 2)
        fields = {
            "version": np.array([1, 0], np.uint8),
            "phi_i": np.linspace(-np.pi, np.pi, azimuths) if azimuths > 1 else np.zeros(1),
            "theta_i": np.array([0.0, 1.5]),
            "sigma": np.full((2, 2), 0.5),
            "ndf": np.full((2, 2), 0.3),
            "vndf": np.ones((*lights, 2, 2)),
            "luminance": np.full((*lights, 2, 2), 0.2),
            colours: np.full((*lights, 3, 2, 2), 0.2),
        }
        if colours == "spectra":
            fields["wavelengths"] = np.array([400.0, 550.0, 700.0])
        singles = {
            name: array if array.dtype == np.uint8 else array.astype("<f4")
            for name, array in fields.items()
        }
        path.write_bytes(tensor_file.pack(singles | {"jacobian": np.array([1], np.uint8)}))

    return write


def _klems(*wavelengths: str) -> Callable[[Format, object], None]:
    def write(_: Format, path) -> None:
        basis = "LBNL/Klems Quarter"
        patches = sum(klems.BASES[basis][1])
        rows = "\n".join(["0.1 " * patches] * patches)
        bases = "".join(f"<{way}AngleBasis>{basis}</{way}AngleBasis>" for way in ("Column", "Row"))
        write_window(path, "dim", "Columns", "", bases, dict.fromkeys(wavelengths, rows))

    return write


def _tree(dimensions: int, *wavelengths: str) -> Callable[[Format, object], None]:
    def write(_: Format, path) -> None:
        leaves = np.linspace(0.1, 0.2, 4**dimensions).reshape((4,) * dimensions)
        data = dict.fromkeys(wavelengths, serialise(leaves, 0.0, 0.0))
        basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>"
        write_window(path, "dim", f"TensorTree{dimensions}", "", basis, data)

    return write


_SHORT = {
    "merl": {"cells": _merl},
    "rgl": {
        "isotropic": _tensor(1, "rgb"),
        "anisotropic": _tensor(3, "rgb"),
        "spectra": _tensor(1, "spectra"),
    },
    "klems": {"grey": _klems("Visible"), "colored": _klems("Visible", "CIE-X", "CIE-Z")},
    "tensortree": {"three": _tree(3, "Visible"), "four": _tree(4, "Visible", "CIE-u", "CIE-v")},
}
"""What writes a short file where the format's own writer makes a long one, by format and name."""
