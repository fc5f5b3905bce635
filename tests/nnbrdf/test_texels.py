import json

import numpy as np
import pytest

from gonio.directions import from_degrees
from nnbrdf.analytic import AnisotropicGGX, Lambert, Sum
from nnbrdf.fused import is_available
from nnbrdf.network import Networks, glorot_uniform
from nnbrdf.texels import ACTIVATION, SIZES, Places, TexelPrior, fit_texels, relight
from nnbrdf.texture import TextureWriter

TEXELS = [
    Sum((Lambert((red, 0.2, 0.1)), AnisotropicGGX((0.05, 0.05, 0.05), rough, rough)))
    for red in (0.1, 0.3, 0.5)
    for rough in (0.3, 0.5)
]
POINTS = np.array([(x, y, 0.0) for x in (-20.0, 0.0, 20.0) for y in (-10.0, 10.0)])
RING = [(0, 0), *((theta, phi) for theta in (25, 50) for phi in range(0, 360, 45))]
STEPS = 600


def places(pairs_deg):
    light, view = (from_degrees(*np.transpose(side)) for side in zip(*pairs_deg, strict=True))
    return Places(2000.0 * light, 2000.0 * view)


def values(where):
    """What each texel truly is, at its own directions, shape (pairs, texels, 3)."""
    seen = [where.inputs(point) for point in POINTS]
    of_texel = [
        material.evaluate(inputs[:, 3:], inputs[:, :3])
        for material, inputs in zip(TEXELS, seen, strict=True)
    ]
    return np.stack(of_texel, axis=1)


PLACES, HELD_OUT = places([(a, b) for a in RING for b in RING]), places([((37, 100), (20, 10))])


@pytest.fixture(scope="module")
def prior():
    centre = (each / np.linalg.norm(each, axis=1, keepdims=True) for each in vars(PLACES).values())
    return TexelPrior.learn(*centre, values(PLACES).mean(axis=1), seed=0)


def error(networks, white):
    truth = values(HELD_OUT)[0]
    return np.abs(relight(networks, white, HELD_OUT, POINTS) - truth).mean() / truth.mean()


@pytest.mark.skipif(not is_available(), reason="the kernel was not compiled")
def test_each_texel_gets_a_network_of_its_own_and_is_relit(prior):
    networks, white = fit_texels(prior, PLACES, POINTS, values(PLACES), steps=STEPS, seed=0)
    mean = Networks(
        tuple(np.repeat(layer, len(POINTS), axis=0) for layer in prior.network.layers), ACTIVATION
    )
    alone = error(mean, np.full(len(POINTS), prior.white))
    assert error(networks, white) < min(0.05, alone / 4)


@pytest.mark.skipif(not is_available(), reason="the kernel was not compiled")
def test_what_no_pair_shows_stays_unknown_and_gaps_do_not_spread(prior):
    seen = values(PLACES)
    seen[:, 0] = np.nan
    seen[::3, 1] = np.nan
    networks, white = fit_texels(prior, PLACES, POINTS, seen, steps=60, seed=0)
    assert np.isnan(white).tolist() == [True, False, False, False, False, False]
    assert all(np.isfinite(layer).all() for layer in networks.layers)
    assert np.isnan(relight(networks, white, HELD_OUT, POINTS)[0]).all()


def test_the_texture_holds_each_tile_where_it_belongs(tmp_path):
    writer = TextureWriter(SIZES, 2, 5)
    networks = glorot_uniform(SIZES, [np.random.default_rng(n) for n in range(10)])
    left, right = networks.select([0, 1, 5, 6]), networks.select([2, 3, 4, 7, 8, 9])
    writer.put(slice(0, 2), slice(0, 2), left, np.array([0.0, 1.0, 5.0, 6.0]))
    writer.put(slice(0, 2), slice(2, 5), right, np.array([2.0, 3.0, 4.0, 7.0, 8.0, 9.0]))
    writer.save(tmp_path / "weights.npz", {"steps": 7})
    with np.load(tmp_path / "weights.npz") as written:
        assert json.loads(str(written["card"])) == {"schema": "gonio.btf-weights/1", "steps": 7}
        assert np.array_equal(written["white"], np.arange(10).reshape(2, 5))
        for index, layer in enumerate(networks.layers):
            texture = written[f"layer_{index}"]
            assert texture.dtype == np.float32
            assert np.array_equal(texture.reshape(layer.shape), layer)
