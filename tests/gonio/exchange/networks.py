"""Small networks of both kinds, as models that can be exported, and pairs to ask them for."""

import numpy as np

from gonio.directions import from_degrees
from nnbrdf.card import Card
from nnbrdf.encoding import INPUTS
from nnbrdf.findings import Findings
from nnbrdf.halfway import HALFWAY_INPUTS
from nnbrdf.model import NNBRDF
from nnbrdf.network import glorot_uniform, weight_count
from nnbrdf.taught import TaughtBRDF, TaughtCard

ENCODINGS = INPUTS | HALFWAY_INPUTS
CHANNELS = ("r", "g", "b")
COMMON = {
    "channels": CHANNELS, "color_space": "linear sRGB", "samples": 100, "steps": 10, "seed": 1,
    "provenance": {},
}  # fmt: skip


def networks(sizes, activation, members):
    """Stacked networks whose outputs vary over the hemisphere, around 0.5."""
    rngs = [np.random.default_rng(each) for each in range(members)]
    result = glorot_uniform(sizes, rngs, activation=activation)
    for layer in result.layers:
        layer[..., -1] = np.random.default_rng(5).normal(size=layer.shape[:2]) / 4
    result.layers[-1][..., -1] = 0.5
    return result


def plain(encoding="xyz", activation="softsign", hidden=(7, 5)):
    """A model of the paper's kind: the second of its three members counts."""
    sizes = (INPUTS[encoding], *hidden, 3)
    card = Card(
        estimator="paper", encoding=encoding, layers=sizes, activation=activation, white=0.7,
        delivered=1, final_losses=(0.3, 0.2, 0.1), weights=weight_count(sizes), trainer="fused",
        diverged=0, **COMMON,
    )  # fmt: skip
    return NNBRDF(card, networks(sizes, activation, 3))


def taught(encoding="isotropic", activation="gelu", hidden=(7, 5), gray=False):
    """A model of the default kind: logarithms, of one spectrum where it is gray."""
    sizes = (HALFWAY_INPUTS[encoding], *hidden, 1 if gray else 3)
    spread = (sizes[0], 2, 1)
    card = TaughtCard(
        estimator="nn", encoding=encoding, layers=sizes, spread_layers=spread,
        activation=activation, scale=0.3, white=0.7, tint=(1.0, 0.5, 0.25),
        weights=weight_count(sizes), teaching_error=0.1, unknown=0.2, left_small=False,
        trainer="fused", prior=None, findings=a_finding(), **COMMON,
    )  # fmt: skip
    return TaughtBRDF(card, networks(sizes, activation, 1), networks(spread, activation, 1))


def a_finding():
    return Findings(
        isotropic=True, isotropic_log_odds=None, reciprocal=True, reciprocal_log_odds=None,
        single_spectrum=None, smooth=0.1, stretch=1, exchange=0, noise=0.1, inflation=1,
        outliers=(), lower_bounds=(), condition=1, jitter=0,
    )  # fmt: skip


def model(encoding, **settings):
    """The kind that has such an encoding."""
    return (plain if encoding in INPUTS else taught)(encoding, **settings)


def exactly(model, light, view):
    """What a model says in double precision, not by the compiled kernel."""
    if isinstance(model, TaughtBRDF):
        return model._told(light, view).median * np.asarray(model.card.tint)
    return model.evaluate(light, view)


def some_pairs(count=500):
    """Single precision, uniform in both angles to 89.9 degrees."""
    rng = np.random.default_rng(7)
    theta, phi = rng.uniform(0.1, 89.9, (2, count)), rng.uniform(1, 359, (2, count))
    return from_degrees(theta, phi).astype(np.float32)
