import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.directions import paper_directions
from gonio.errors import BadInputError, MissingExtraError
from gonio.materials import Lambertian, MeasuredTable
from nnbrdf.analytic import AnisotropicGGX
from nnbrdf.difference import delta_e_2000, expose_sphere, psnr_db
from nnbrdf.sphere import shade_sphere, sphere_rays
from nnbrdf.sphere_table import shade_table

BRUSHED = AnisotropicGGX((1.0, 0.8, 0.6), alpha_x=0.15, alpha_y=0.5)
ACROSS = AnisotropicGGX((1.0, 0.8, 0.6), alpha_x=0.5, alpha_y=0.15)


def table_of(material):
    grid = paper_directions()
    return material.evaluate(grid[:, None], grid[None])


def grid(value):
    return np.full((81, 81, 3), float(value))


def picture(*pixels):
    return np.array(pixels, np.uint8)


@settings(max_examples=10)
@given(seed=st.integers(0, 100), size=st.sampled_from([5, 24]))
def test_a_table_is_rendered_as_the_material_it_is(seed, size):
    values = np.random.default_rng(seed).lognormal(size=(81, 81, 3))
    direct = shade_sphere(MeasuredTable(values, 1.0), size)
    np.testing.assert_allclose(shade_table(values, size), direct, rtol=1e-12, atol=1e-12)


def test_rays_come_from_the_upper_hemisphere_and_fall_on_the_picture():
    for rays in sphere_rays(9):
        assert (rays.light[:, 2] > 0).all()
        assert (rays.view[:, 2] > 0).all()
        assert (rays.weight > 0).all()
        assert len(np.unique(rays.pixel)) == len(rays.pixel)
        assert 0 <= rays.pixel.min() <= rays.pixel.max() < 81
        for direction in (rays.light, rays.view):
            np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1.0)


def test_light_and_eye_keep_their_angle_whatever_surface_they_meet():
    for rays in sphere_rays(40):
        cosine = np.einsum("ij,ij->i", rays.light, rays.view)
        assert np.allclose(cosine, cosine[0], atol=1e-12)


def test_a_white_diffuser_is_exposed_up_to_255_and_only_the_sphere_is_seen():
    seen = expose_sphere(Lambertian(1.0), white=1 / np.pi)
    assert seen.max() == 255
    # a sphere that fills the picture covers pi / 4 of it; the rim is left out
    assert 0.97 < len(seen) / (np.pi / 4 * 128**2) < 1.0
    assert (seen == 0).all(axis=1).mean() < 0.01


def test_exposure_ends_at_white():
    bright = expose_sphere(grid(8.0), white=1.0)
    assert (expose_sphere(grid(16.0), white=1.0) == 255).sum() > (bright == 255).sum() > 0
    assert (expose_sphere(grid(-1.0), white=1.0) == 0).all()


def test_the_body_is_a_quarter_of_white():
    # facing the softbox 1/4 of full scale, in sRGB 137
    assert expose_sphere(grid(0.25), white=1.0).max() == pytest.approx(137, abs=1)


def test_body_highlight_and_grain_all_show():
    table, white = table_of(BRUSHED), MeasuredTable.of(table_of(BRUSHED)).white
    true = expose_sphere(table, white)
    clipped = (true == 255).any(axis=1).mean()
    assert 0.001 < clipped < 0.3
    assert psnr_db(expose_sphere(table_of(ACROSS), white), true) < 25
    off_specular = table.copy()
    off_specular[table > 2 * np.median(table)] *= 0.5
    assert psnr_db(expose_sphere(off_specular, white), true) < 30


def test_a_material_is_seen_directly_too():
    direct = expose_sphere(Lambertian(0.5), white=0.5)
    assert (direct == expose_sphere(grid(0.5 / np.pi), white=0.5)).mean() > 0.999


def test_psnr_by_hand():
    black = picture((0, 0, 0), (0, 0, 0))
    assert psnr_db(black, black) == np.inf
    assert psnr_db(picture((255, 255, 255), (255, 255, 255)), black) == 0.0
    # one of six values off by 51: 255^2 / (51^2 / 6) = 150
    assert psnr_db(picture((51, 0, 0), (0, 0, 0)), black) == pytest.approx(10 * np.log10(150))
    # 8-bit differences below zero do not wrap
    assert psnr_db(black, picture((51, 0, 0), (0, 0, 0))) == pytest.approx(10 * np.log10(150))


class TestDeltaE:
    """Needs the extra `color`."""

    @pytest.fixture(autouse=True)
    def _colour(self):
        pytest.importorskip("colour", reason="needs the extra color")

    def test_black_and_white_are_100_apart(self):
        difference = delta_e_2000(picture((0, 0, 0), (9, 9, 9)), picture((255,) * 3, (9, 9, 9)))
        assert difference == pytest.approx([100, 0], abs=1e-3)

    def test_of_sharma_wu_and_dalal(self):
        """Their published values are in Lab: the function called is the one that gives them."""
        import colour

        lab = np.array([50.0, 2.6772, -79.7751]), np.array([50.0, 0.0, -82.7485])
        assert colour.delta_E(*lab, method="CIE 2000") == pytest.approx(2.0425, abs=1e-4)

    @given(st.lists(st.tuples(*[st.integers(0, 255)] * 6), min_size=1, max_size=5))
    def test_symmetric_and_zero_for_the_same(self, pairs):
        one, other = np.split(np.array(pairs, np.uint8), 2, axis=1)
        there, back = delta_e_2000(one, other), delta_e_2000(other, one)
        assert there == pytest.approx(back, abs=1e-9)
        assert (there >= 0).all()
        assert delta_e_2000(one, one) == pytest.approx(0.0, abs=1e-9)


def test_delta_e_without_the_extra_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "colour", None)
    with pytest.raises(MissingExtraError, match=r"colour-science.*gonio\[color\]"):
        delta_e_2000(picture((0, 0, 0)), picture((0, 0, 0)))


BAD = {
    "shape": ((np.ones((81, 3)), 1.0), "a table of shape"),
    "NaN": ((grid(np.nan), 1.0), "not finite"),
    "a material's NaN": ((Lambertian(np.nan), 1.0), "not finite"),
    "white": ((grid(1), 0.0), "white is 0, not positive"),
    "white is NaN": ((grid(1), np.nan), "white is nan, not positive"),
}


@pytest.mark.parametrize(("arguments", "problem"), BAD.values(), ids=BAD)
def test_refuses_what_has_no_picture(arguments, problem):
    with pytest.raises(BadInputError, match=problem):
        expose_sphere(*arguments)
