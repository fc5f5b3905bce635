"""The plugin inside Mitsuba itself, in the variant that every machine has."""

import importlib.util

import numpy as np
import pytest

from gonio.directions import from_degrees
from gonio.exchange.networks.mitsuba_plugin import text_of
from gonio.exchange.networks.portable import portable_of, symbol_of
from nnbrdf.albedo import directional_albedo
from tests.gonio.exchange.networks import exactly, plain, some_pairs, taught

mi = pytest.importorskip("mitsuba")
MODELS = {
    "isotropic": (taught(), False),
    "grained": (taught("anisotropic-exchange"), True),
    "angles": (plain("sincos"), True),
}
DRAWS = 400


@pytest.fixture(scope="module")
def bsdfs(tmp_path_factory):
    """Each model as a BSDF of a scene, from its file."""
    mi.set_variant("scalar_rgb")
    folder, made = tmp_path_factory.mktemp("plugins"), {}
    for name, (model, anisotropic) in MODELS.items():
        path = folder / f"{name}_bsdf.py"
        path.write_text(text_of(portable_of(model, name), path.stem, anisotropic))
        spec = importlib.util.spec_from_file_location(path.stem, path)
        spec.loader.exec_module(importlib.util.module_from_spec(spec))
        made[name] = mi.load_dict({"type": symbol_of(name)})
    return made


def seen_from(direction):
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(*map(float, direction))
    return si


def value(bsdf, light, view, mode=None):
    context = mi.BSDFContext() if mode is None else mi.BSDFContext(mode)
    return np.array(bsdf.eval(context, seen_from(view), mi.Vector3f(*map(float, light))))


@pytest.mark.parametrize("name", MODELS)
def test_eval_is_the_model_times_the_cosine_of_the_light(name, bsdfs):
    light, view = some_pairs(40)
    expected = exactly(MODELS[name][0], light.astype(float), view.astype(float)) * light[:, 2:]
    told = np.stack([value(bsdfs[name], *pair) for pair in zip(light, view, strict=True)])
    assert np.abs(told - expected).max() < 1e-5 * expected.max()


def test_a_path_from_the_light_asks_for_the_same_pair(bsdfs):
    light, view = (each[0] for each in some_pairs(1))
    forth = value(bsdfs["angles"], light, view) / light[2]
    back = value(bsdfs["angles"], view, light, mi.TransportMode.Importance) / view[2]
    assert back == pytest.approx(forth, rel=1e-5)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("theta_deg", [0.0, 75.0])
def test_samples_are_weighed_by_the_density_that_pdf_tells_and_add_up_to_the_albedo(
    name, theta_deg, bsdfs
):
    bsdf, si = bsdfs[name], seen_from(from_degrees(theta_deg, 30.0))
    rng, context, weights = np.random.default_rng(2), mi.BSDFContext(), []
    for one, *two in rng.random((DRAWS, 3)).tolist():
        drawn, weight = bsdf.sample(context, si, one, mi.Point2f(two))
        assert drawn.pdf == pytest.approx(bsdf.pdf(context, si, drawn.wo), rel=1e-4)
        if drawn.pdf > 0:
            told = np.array(bsdf.eval(context, si, drawn.wo)) / drawn.pdf
            assert np.array(weight) == pytest.approx(told, rel=1e-4)
        weights.append(np.array(weight))
    mean, error = np.mean(weights, axis=0), np.std(weights, axis=0) / np.sqrt(DRAWS)
    expected = albedo(MODELS[name][0], from_degrees(theta_deg, 30.0))
    assert (np.abs(mean - expected) < 4 * error).all()
    assert (error < 0.02 * mean).all()


def albedo(model, view):
    """Integral over lights, by midpoints of equal projected solid angle."""
    radius = np.sqrt((np.arange(60) + 0.5) / 60)[:, None] * np.ones(120)
    phi = 2 * np.pi * (np.arange(120) + 0.5) / 120
    lights = np.stack(
        [radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - radius**2)], axis=-1
    ).reshape(-1, 3)
    return np.pi * exactly(model, lights, np.broadcast_to(view, lights.shape)).mean(axis=0)


def test_below_the_horizon_there_is_nothing(bsdfs):
    light, view = (each[0] for each in some_pairs(1))
    assert (value(bsdfs["isotropic"], -light, view) == 0).all()
    assert (value(bsdfs["isotropic"], light, -view) == 0).all()


def test_a_scene_is_rendered_with_it(bsdfs):
    shape = {"type": "sphere", "bsdf": {"type": symbol_of("isotropic")}}
    sensor = {
        "type": "perspective", "fov": 40,
        "to_world": mi.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0]),
        "film": {"type": "hdrfilm", "width": 4, "height": 4, "rfilter": {"type": "box"}},
        "sampler": {"type": "independent", "sample_count": 4},
    }  # fmt: skip
    scene = {"type": "scene", "integrator": {"type": "path"}, "sensor": sensor, "shape": shape,
             "light": {"type": "constant"}}  # fmt: skip
    picture = np.array(mi.render(mi.load_dict(scene)))
    centre = picture[1:3, 1:3].mean(axis=(0, 1))
    expected = directional_albedo(MODELS["isotropic"][0])[1].value
    assert centre == pytest.approx(expected, rel=0.15)
