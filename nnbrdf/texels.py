"""An NN-BRDF for each texel, all of which start from the network of the mean material."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import normalize
from nnbrdf.cores import cores
from nnbrdf.encoding import ENCODINGS, INPUTS
from nnbrdf.network import Networks, glorot_uniform
from nnbrdf.training import RATE, make_trainer, train

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Progress

ENCODING: Final = "xyz"
ACTIVATION: Final = "softsign"
SIZES: Final = (INPUTS[ENCODING], 3, 6, 4, 3)
"""The paper's small network (Mikes and Haindl 2023): 88 weights."""

STEPS: Final = 600
_PRIOR_STEPS, _PRIOR_STARTS = 20_000, 5
_FINE_RATE = RATE / 5
_WHITE = 4.0
# of the mean material's white: darker texels are noise, and would be blown up
_DARKEST = 1e-3


@dataclass(frozen=True)
class TexelPrior:
    """What is believed of a texel before it is looked at.

    Attributes
    ----------
    network
        That of the mean material, one member.
    white
        What its output of 1 means, in 1/sr.
    """

    network: Networks
    white: float

    @classmethod
    def learn(
        cls,
        light: NDArray[np.float64],
        view: NDArray[np.float64],
        values: NDArray[np.float64],
        seed: int,
        progress: Progress | None = None,
    ) -> TexelPrior:
        """Train a few networks on the mean material and keep the one that fits best.

        Parameters
        ----------
        light, view
            Unit vectors, shape (pairs, 3) each.
        values
            Its BRDF in 1/sr, shape (pairs, 3).
        seed
            Of starts and orders.
        progress
            Called with the steps done and of all.
        """
        generators = [
            np.random.default_rng(each)
            for each in np.random.SeedSequence(seed).spawn(_PRIOR_STARTS)
        ]
        start = glorot_uniform(SIZES, generators, activation=ACTIVATION)
        seeds = [int(each.integers(2**63)) for each in generators]
        white = _WHITE * float(np.median(values))
        inputs, targets = ENCODINGS[ENCODING](light, view), np.clip(values / white, 0.0, 1.0)
        end = train(start, inputs, targets, _PRIOR_STEPS, seeds, progress)[-1]
        return cls(end.networks.member(int(np.nanargmin(end.loss))), white)


@dataclass(frozen=True)
class Places:
    """Where lamps and camera were at each pair, in mm, shape (pairs, 3) each."""

    light_mm: NDArray[np.float64]
    view_mm: NDArray[np.float64]

    def inputs(self, point_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the networks' inputs for each pair as a point sees it, shape (pairs, inputs)."""
        directions = (normalize(each - point_mm) for each in (self.light_mm, self.view_mm))
        return ENCODINGS[ENCODING](*directions)


def fit_texels(
    prior: TexelPrior,
    places: Places,
    points_mm: NDArray[np.float64],
    values: NDArray[np.float32],
    *,
    steps: int,
    seed: int,
) -> tuple[Networks, NDArray[np.float64]]:
    """Train a network for each texel, as many at once as there are cores.

    Few steps from a common start: what a texel's samples do not tell stays as in the mean material.

    Parameters
    ----------
    prior
        Where all start.
    places
        Of each pair.
    points_mm
        Middle of each texel, shape (n, 3).
    values
        BRDF in 1/sr, shape (pairs, n, 3); NaN where a pair does not show a texel.
    steps
        Batches of 32; the last third at a fifth of the rate.
    seed
        Of the order of the samples; the same for all texels.

    Returns
    -------
    networks
        One a texel.
    white
        What an output of 1 means, in 1/sr, shape (n,); NaN for a texel that no pair shows.
    """

    def fit(index: int) -> tuple[Networks, float]:
        inputs = places.inputs(points_mm[index])
        return _fit(prior, inputs, values[:, index].astype(np.float64), steps, seed)

    with ThreadPoolExecutor(cores()) as pool:
        fitted = list(pool.map(fit, range(len(points_mm))))
    layers = zip(*(networks.layers for networks, _ in fitted), strict=True)
    networks = Networks(tuple(np.concatenate(layer) for layer in layers), ACTIVATION)
    return networks, np.array([white for _, white in fitted])


def _fit(
    prior: TexelPrior,
    inputs: NDArray[np.float64],
    values: NDArray[np.float64],
    steps: int,
    seed: int,
) -> tuple[Networks, float]:
    usable = np.isfinite(values).all(axis=-1)
    if not usable.any():
        return prior.network, np.nan
    white = max(_WHITE * float(np.median(values[usable])), _DARKEST * prior.white)
    targets = np.clip(values[usable] / white, 0.0, 1.0)
    networks = prior.network
    for share, rate in ((steps - steps // 3, RATE), (steps // 3, _FINE_RATE)):
        trainer = make_trainer(networks, inputs[usable], targets, [seed], rate=rate)
        trainer.run(share)
        networks = trainer.networks()
    return networks, white


def relight(
    networks: Networks,
    white: NDArray[np.float64],
    place: Places,
    points_mm: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return what each texel's network says of one pair, in 1/sr, shape (n, 3).

    Parameters
    ----------
    networks, white, points_mm
        As `fit_texels` takes and returns them.
    place
        Of one pair.
    """
    inputs = np.stack([place.inputs(point) for point in points_mm])
    relative = networks.forward(inputs)[:, 0]
    return np.asarray(white[:, None] * relative.clip(0.0))
