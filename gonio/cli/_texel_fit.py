"""The fit of a network for each texel, tile by tile, with a pair held out to be relit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.cli._console import progress_bar
from gonio.directions import from_degrees, normalize
from gonio.errors import BadInputError
from gonio.report.relit import write_relit
from gonio.report.screen import Screen
from nnbrdf.texels import SIZES, Places, TexelPrior, fit_texels, relight
from nnbrdf.texture import TextureWriter

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.reduce.btf import Texels

_PRIOR_TILES = 16
_FEWEST = 8
_HELD_OUT_DEG: Final = {"light": (30.0, 90.0), "view": (30.0, 0.0)}
"""The pair nearest to this one is: off the mirror direction and off the rim."""


def fit_middle(texels: Texels, folder: Path, steps: int, seed: int) -> float:
    """Write weights and picture; return the mean absolute error of the picture over its mean.

    What is held at a time is one tile with all pairs, however large the array is.

    Raises
    ------
    gonio.errors.BadInputError
        When fewer than 8 pairs were measured, or none shows the middle.
    """
    pairs, held_out = _split(texels)
    places, place = _places(texels, pairs), _places(texels, held_out)
    prior = _prior(texels, pairs, seed)
    writer = TextureWriter(SIZES, texels.side, texels.side)
    measured, relit = np.full((2, texels.side, texels.side, 3), np.nan, np.float32)
    with progress_bar("fitting texels") as progress:
        for tile in texels.tiles():
            points, within = texels.points_mm(tile), texels.within(tile)
            values = texels.values(tile, pairs)
            networks, white = fit_texels(prior, places, points, values, steps=steps, seed=seed)
            writer.put(*within, networks, white)
            shape = relit[within].shape
            relit[within] = relight(networks, white, place, points).reshape(shape)
            measured[within] = texels.values(tile, held_out).reshape(shape)
            progress(within[0].stop * texels.side, texels.side**2)
    facts = {"sizes": SIZES, "steps": steps, "seed": seed, "source": dict(texels.btf.group.attrs)}
    writer.save(folder / "weights.npz", facts)
    screen = Screen.of(texels.btf.group.attrs["color_space"])
    write_relit(folder / "relit.png", *map(screen.shown, (measured, relit)))
    return float(np.nanmean(np.abs(relit - measured)) / np.nanmean(np.abs(measured)))


def _split(texels: Texels) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the pairs to learn from, and the one to be relit, shape (1, 2)."""
    pairs = texels.pairs()
    if len(pairs) < _FEWEST:
        raise BadInputError(
            f"{texels.btf.path}: {len(pairs)} pairs are too few for networks; measure at least "
            f"{_FEWEST}"
        )
    near = np.zeros(len(pairs))
    for column, (side, angles_deg) in enumerate(_HELD_OUT_DEG.items()):
        near += texels.btf.group[side][...][pairs[:, column]] @ from_degrees(*angles_deg)
    held_out = int(near.argmax())
    return np.delete(pairs, held_out, axis=0), pairs[held_out : held_out + 1]


def _places(texels: Texels, pairs: NDArray[np.intp]) -> Places:
    light, view = pairs.T
    group = texels.btf.group
    return Places(group["light_mm"][...][light, view], group["view_mm"][...][light, view])


def _prior(texels: Texels, pairs: NDArray[np.intp], seed: int) -> TexelPrior:
    """Learn the mean material from a few tiles that are spread over the middle."""
    tiles = list(texels.tiles())
    some = tiles[:: -(-len(tiles) // _PRIOR_TILES)]
    totals, counts = np.zeros((len(pairs), 3)), np.zeros((len(pairs), 3))
    for tile in some:
        values = texels.values(tile, pairs)
        totals += np.nansum(values, axis=1, dtype=np.float64)
        counts += np.isfinite(values).sum(axis=1)
    seen = (counts > 0).all(axis=1)
    if seen.sum() < _FEWEST:
        raise BadInputError(
            f"{texels.btf.path}: the middle is seen by {seen.sum()} pairs alone; fit more of it "
            "with a larger --side"
        )
    places = _places(texels, pairs[seen])
    with progress_bar("learning the mean material") as progress:
        return TexelPrior.learn(
            normalize(places.light_mm),
            normalize(places.view_mm),
            totals[seen] / counts[seen],
            seed,
            progress,
        )
