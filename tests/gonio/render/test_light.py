"""The probe's lights, and what a shape makes of them."""

import numpy as np
import pytest

from gonio.materials import Lambertian, MeasuredTable
from gonio.render import PROBES, SHAPES, shade
from gonio.render.tabled import quick
from nnbrdf.analytic import AnisotropicGGX
from sim.materials import EMBEDDED

WHITE = {"white": Lambertian(1.0)}


def integral(probe):
    edges = np.cos(np.pi * np.arange(257) / 256)
    area = (edges[:-1] - edges[1:]) * 2 * np.pi / 512
    return (probe.panorama() * area[:, None, None]).sum(axis=(0, 1))


@pytest.mark.parametrize("name", PROBES)
def test_the_lights_bring_what_the_probe_sends(name):
    lights = PROBES[name].lights(1024)
    assert np.allclose(np.linalg.norm(lights.direction, axis=1), 1.0)
    assert np.allclose(lights.power.sum(axis=0), integral(PROBES[name]), rtol=0.02)


def test_more_of_the_lights_are_where_it_is_bright():
    lights = PROBES["sky"].lights(400)
    bright = PROBES["sky"].radiance(lights.direction).max(axis=1) > 100
    # the sun is a thousandth of the sphere
    assert 0.2 < bright.mean() < 0.7


def test_a_white_sphere_vanishes_in_the_furnace():
    picture = shade(WHITE, SHAPES["sphere"], PROBES["furnace"].lights(512), 24)["white"]
    inside = picture.cover == 1.0
    assert np.allclose(picture.color[inside], 1.0, atol=0.004)
    assert not picture.color[picture.cover == 0].any()


def test_folds_shade_themselves_in_the_furnace():
    picture = shade(WHITE, SHAPES["drape"], PROBES["furnace"].lights(256), 32)["white"]
    inside = picture.color[picture.cover == 1.0].mean(axis=-1)
    assert inside.max() < 1.01
    assert inside.min() < 0.75


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_seen_faces_the_eye_and_has_right_angles(name):
    seen = SHAPES[name].look(32, 0.5, 0.5)
    assert 300 < len(seen.pixel) < 1024
    assert (seen.frame[:, 2, 2] > 0).mean() > 0.99
    unit = seen.frame @ np.swapaxes(seen.frame, 1, 2)
    assert np.allclose(unit, np.eye(3), atol=1e-9)
    assert np.allclose(np.linalg.det(seen.frame), 1.0)


def test_cloth_has_no_walls_below_its_edge():
    shape = SHAPES["drape"]
    seen = shape.look(64, 0.5, 0.5)
    row, column = np.divmod(seen.pixel, 64)
    right, up = (column + 0.5) / 32 - 1, 1 - (row + 0.5) / 32
    # the middle of its lower edge in the picture
    edge = np.array([0.0, -1.0, shape.height(np.array(0.0), np.array(-1.0))])
    x, y = (edge @ shape.axes)[:2] * shape.scale + shape.shift
    assert up[np.abs(right - x) < 0.04].min() > y - 0.04


def test_grain_shows():
    along, across = AnisotropicGGX((0.9,) * 3, 0.1, 0.5), AnisotropicGGX((0.9,) * 3, 0.5, 0.1)
    pictures = shade(
        {"along": along, "across": across}, SHAPES["sphere"], PROBES["studio"].lights(32), 24
    )
    one, other = (each.color for each in pictures.values())
    assert np.abs(one - other).mean() > 0.2 * one.mean()


def test_threads_and_company_do_not_change_a_bit(monkeypatch):
    table = MeasuredTable.of(np.random.default_rng(0).lognormal(size=(81, 81, 3)))
    lights = PROBES["studio"].lights(32)
    monkeypatch.setattr("gonio.render.shading.cores", lambda: 1)
    alone = shade({"table": table}, SHAPES["sphere"], lights, 16)["table"]
    monkeypatch.setattr("gonio.render.shading.cores", lambda: 3)
    velvet = EMBEDDED["velvet"].material
    beside = shade({"velvet": velvet, "table": table}, SHAPES["sphere"], lights, 16)["table"]
    assert np.array_equal(alone.color, beside.color)


def test_the_quick_table_is_the_table():
    rng = np.random.default_rng(1)
    table = MeasuredTable.of(rng.lognormal(size=(81, 81, 3)))
    directions = rng.normal(size=(2, 4000, 3))
    directions[..., 2] = np.abs(directions[..., 2])
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    directions[:, 0] = [0.0, 0.0, 1.0]
    assert np.allclose(quick(table).evaluate(*directions), table.evaluate(*directions), rtol=1e-9)
