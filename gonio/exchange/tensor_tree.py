"""Radiance's tensor tree: a BSDF on squares that are small where it varies, as LBNL's XML.

Directions, halves and order as Radiance's `bsdf_t.c` reads them: an anisotropic tree is over the
squares (see `shirley_chiu`) of where the light goes to and of the view; an isotropic one over
half of 1 - sin theta of the light, and the square of the view with the light at phi 180 deg.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadFileError
from gonio.exchange.blocks import evaluate_in_blocks
from gonio.exchange.format import Format, Source
from gonio.exchange.isotropy import ISOTROPIC_BELOW
from gonio.exchange.shirley_chiu import disk_from_square, square_from_disk
from gonio.exchange.tree import Tree, parse, serialise
from gonio.exchange.window_xml import (
    REMEDY,
    WindowFile,
    is_window,
    read_window,
    rgb_of,
    text_of,
    write_window,
    xyz_of,
)

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.protocols import Material, Progress

    Array = NDArray[np.float64]

_ISOTROPIC, _ANISOTROPIC = 64, 32
_MERGED = 0.05
_CHROMA_MERGED = 0.004
# in 1/sr
_BLACK = 1e-6
_BASIS = "LBNL/Shirley-Chiu"
_STRUCTURES = {"tensortree3": 3, "tensortree4": 4}


@dataclass(frozen=True)
class TensorTree:
    """A material in cubes of a tree, without interpolation, as Radiance reads it.

    Attributes
    ----------
    luminance
        BRDF in 1/sr.
    chroma
        CIE 1976 u' and v', where the file says them.
    mirrored
        Whether x runs the other way.
    """

    luminance: Tree
    chroma: tuple[Tree, Tree] | None = None
    mirrored: bool = False

    def evaluate(self, light: Array, view: Array) -> Array:
        """Return the BRDF in 1/sr, shape (..., 3)."""
        light, view = np.broadcast_arrays(light, view)
        place = _place(light.reshape(-1, 3), view.reshape(-1, 3), self)
        luminance = self.luminance.at(place)
        if self.chroma is None:
            rgb = np.repeat(luminance[:, None], 3, axis=1)
        else:
            rgb = rgb_of(_xyz_from_chroma(luminance, *(each.at(place) for each in self.chroma)))
        return rgb.reshape(light.shape)


def _place(light: Array, view: Array, tree: TensorTree) -> Array:
    """Return where pairs of shape (n, 3) lie in the tree, shape (n, 3) or (n, 4)."""
    to, out = -light[:, :2], view[:, :2]
    if tree.mirrored:
        to, out = to * [-1.0, 1.0], out * [-1.0, 1.0]
    if tree.luminance.dimensions == 4:
        return np.concatenate([square_from_disk(to), square_from_disk(out)], axis=1)
    sine = np.hypot(to[:, 0], to[:, 1])
    turned = _turned_back(out, to, sine)
    first = (0.5 - 1e-7) - 0.5 * sine.clip(0.0, 1.0)
    return np.concatenate([first[:, None], square_from_disk(turned)], axis=1)


def _turned_back(out: Array, to: Array, sine: Array) -> Array:
    """Return places of a disk turned so that `to`, of length `sine`, lies along x."""
    cos, sin = np.where(sine[:, None] > 0, to, [1.0, 0.0]).T / np.where(sine > 0, sine, 1.0)
    return np.stack([cos * out[:, 0] + sin * out[:, 1], cos * out[:, 1] - sin * out[:, 0]], axis=1)


def sampled(
    material: Material, dimensions: int, count: int, progress: Progress | None = None
) -> Array:
    """Return the BRDF at the middles of `count` parts a dimension, shape (count, ..., count, 3)."""
    middle = (np.arange(count) + 0.5) / count
    disk = disk_from_square(np.stack(np.meshgrid(middle, middle, indexing="ij"), axis=-1))
    view = _risen(disk).reshape(-1, 3)
    if dimensions == 4:
        light = view * [-1.0, -1.0, 1.0]
    else:
        # light comes from phi 180 deg; the other half is never looked at, and mirrored merges
        light = _risen(np.stack([-np.abs(1.0 - 2.0 * middle), 0.0 * middle], axis=1))
    shape = (len(light), len(view), 3)
    pairs = np.broadcast_to(light[:, None], shape), np.broadcast_to(view, shape)
    values = evaluate_in_blocks(
        material, pairs[0].reshape(-1, 3), pairs[1].reshape(-1, 3), progress
    )
    return values.reshape(*(count,) * dimensions, 3)


def _risen(disk: Array) -> Array:
    height = np.sqrt((1.0 - (disk**2).sum(axis=-1)).clip(0.0))
    return np.concatenate([disk, height[..., None]], axis=-1)


def write(source: Source, path: Path, progress: Progress | None) -> None:
    """Write a tree of the luminance and, for Radiance, two of the chromaticity."""
    dimensions = 3 if source.anisotropy <= ISOTROPIC_BELOW else 4
    count = _ISOTROPIC if dimensions == 3 else _ANISOTROPIC
    xyz = xyz_of(sampled(source.material, dimensions, count, progress).clip(0.0))
    # of a tree with one exact zero Radiance was seen to return one value everywhere
    luminance = xyz[..., 1].clip(_BLACK)
    if dimensions == 3:
        # Radiance takes a Lambertian part off, and with it (bsdf_t.c, subtract_min_RGB) the colour
        # of an isotropic tree; a black cube leaves none: light and view beyond 75 deg, 45 deg apart
        luminance[0, 0, 0] = _BLACK
    dark = 1e-3 * float(luminance.mean())
    data = {"Visible": serialise(luminance, _MERGED, dark)}
    for name, each in zip(("CIE-u", "CIE-v"), _chroma_from_xyz(xyz), strict=True):
        data[name] = serialise(each, 0.0, _CHROMA_MERGED)
    structure = f"TensorTree{dimensions}"
    write_window(path, source.name, structure, "", f"<AngleBasis>{_BASIS}</AngleBasis>\n", data)


def read(path: Path) -> TensorTree:
    """Read a tree.

    Raises
    ------
    gonio.errors.BadFileError
        When it is none, or of another basis, or its braces do not fit.
    """
    file = read_window(path)
    dimensions = _STRUCTURES.get(file.structure.lower())
    if dimensions is None:
        raise BadFileError(path, f"holds {file.structure[:20]!r}, no tensor tree", REMEDY)
    luminance = _tree(path, file, "visible", dimensions)
    chroma: Any = None
    if {"cie-u", "cie-v"} <= set(file.blocks):
        chroma = tuple(_tree(path, file, name, dimensions) for name in ("cie-u", "cie-v"))
    return TensorTree(luminance, chroma, file.mirrored)


def _tree(path: Path, file: WindowFile, name: str, dimensions: int) -> Tree:
    block = file.blocks[name]
    basis = text_of(block, "AngleBasis")
    if basis.lower() != _BASIS.lower():
        raise BadFileError(path, f"is of the basis {basis[:40]!r}, not of {_BASIS}", REMEDY)
    try:
        return parse(text_of(block, "ScatteringData"), dimensions)
    except ValueError as error:
        raise BadFileError(path, f"its tree of {name} {error}", REMEDY) from None


def _chroma_from_xyz(xyz: Array) -> tuple[Array, Array]:
    """Return CIE 1976 u' and v' (ISO/CIE 11664-5), those of white where it is black."""
    x, y, z = np.moveaxis(xyz, -1, 0)
    total = x + 15.0 * y + 3.0 * z
    lit = np.where(total > 0, total, 1.0)
    white = xyz_of(np.ones(3))
    bright = white @ [1.0, 15.0, 3.0]
    u = np.where(total > 0, 4.0 * x / lit, 4.0 * white[0] / bright)
    return u, np.where(total > 0, 9.0 * y / lit, 9.0 * white[1] / bright)


def _xyz_from_chroma(luminance: Array, u: Array, v: Array) -> Array:
    v = np.maximum(v, 1e-3)
    x = luminance * 9.0 * u / (4.0 * v)
    z = luminance * (12.0 - 3.0 * u - 20.0 * v) / (4.0 * v)
    return np.stack([x, luminance, z], axis=-1)


FORMAT = Format(
    name="tensortree",
    suffix=".xml",
    title="tensor tree that is fine where the material varies, as Radiance reads it",
    keeps="cubes of a 32nd (isotropic: a 64th) of the disk to five digits, merged where they "
    "differ by no more than 5 %, anisotropy, up to the horizon, colour as chromaticity",
    loses="highlights finer than a cube, sigma",
    write=write,
    read=read,
    claims=lambda head, size: is_window(head, tree=True),
)
