"""Mitsuba's pictures beside our own: the same eye, probe, shapes, marked edge and material."""

import numpy as np
import pytest

from gonio.exchange import rgl_writing
from gonio.materials import Lambertian
from gonio.render import PROBES, SHAPES, shade
from gonio.render.contrast import contrast, exposure
from gonio.render.traced import Traced
from sim.materials import EMBEDDED

mitsuba = pytest.importorskip("mitsuba")
SIZE, LIGHTS = 48, 384


class OneWay:
    """Sends back less light from the side, however it is seen: its two ways of light differ."""

    def evaluate(self, light, view):
        light, _ = np.broadcast_arrays(light, view)
        return np.repeat(0.2 * light[..., 2:], 3, axis=-1)


MATERIALS = {
    "matte": EMBEDDED["matte-paint"].material,
    "grooved": EMBEDDED["brushed-metal"].material,
    "one-way": OneWay(),
}
WHITE = {"white": Lambertian(1.0)}


@pytest.fixture(scope="module")
def traced():
    with pytest.MonkeyPatch.context() as patch:
        # coarse, to be quick
        patch.setattr(rgl_writing, "_NODES", 32)
        patch.setattr(rgl_writing, "_PHI_STEP_DEG", 20.0)
        return Traced.of(MATERIALS)


@pytest.fixture(autouse=True)
def coarse_reliefs(monkeypatch):
    monkeypatch.setattr("gonio.render.mesh._SIDE", 97)


@pytest.mark.parametrize(
    ("shape", "least_db"),
    [
        ("sphere", {"matte": 40.0, "grooved": 31.0, "one-way": 40.0}),
        # the reliefs' own shadows have soft edges
        ("drape", {"grooved": 26.0}),
        ("panel", {"grooved": 28.0}),
    ],
)
def test_direct_light_is_as_our_own(traced, monkeypatch, shape, least_db):
    monkeypatch.setattr("gonio.render.traced._DEPTH", 2)
    probe, materials = PROBES["studio"], {name: MATERIALS[name] for name in least_db}
    some = Traced({name: traced.bsdfs[name] for name in least_db})
    pictures = some.shade(SHAPES[shape], probe, LIGHTS, SIZE)
    own = shade(materials, SHAPES[shape], probe.lights(LIGHTS), SIZE)
    for name, reference in own.items():
        found = contrast(pictures[name], reference, exposure([reference]))
        assert found.psnr_db > least_db[name], (name, found.psnr)
        cover = pictures[name].cover
        assert abs(cover.mean() - reference.cover.mean()) < 0.005
        assert (cover == 1.0).sum() > 0.9 * (reference.cover == 1.0).sum()
        assert not pictures[name].color[cover == 0.0].any()


def test_a_white_sphere_vanishes_in_the_furnace():
    picture = Traced.of(WHITE).shade(SHAPES["sphere"], PROBES["furnace"], LIGHTS, SIZE)["white"]
    inside = picture.color[picture.cover == 1.0]
    np.testing.assert_allclose(inside.mean(axis=0), 1.0, atol=0.002)


def test_folds_light_each_other(monkeypatch):
    white, drape, furnace = Traced.of(WHITE), SHAPES["drape"], PROBES["furnace"]
    whole = _darkest(white.shade(drape, furnace, 96, 32)["white"])
    monkeypatch.setattr("gonio.render.traced._DEPTH", 2)
    direct = _darkest(white.shade(drape, furnace, 96, 32)["white"])
    assert direct < 0.75
    assert direct + 0.1 < whole < 1.0


def _darkest(picture):
    return np.percentile(picture.color[picture.cover == 1.0], 2)


def test_one_seed_is_one_picture_and_the_variant_stays(traced):
    with mitsuba.variant_context("scalar_spectral"):
        first, again = (
            traced.shade(SHAPES["sphere"], PROBES["sky"], 24, 16)["matte"] for _ in range(2)
        )
        assert mitsuba.variant() == "scalar_spectral"
    assert np.array_equal(first.color, again.color)
