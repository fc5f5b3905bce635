import numpy as np
import pytest

from nnbrdf.albedo import INCIDENCES_DEG, directional_albedo


class Lambert:
    def evaluate(self, light, view):
        shape = np.broadcast_shapes(light.shape, view.shape)
        return np.broadcast_to(np.array([0.2, 0.5, 0.8]) / np.pi, shape)


class Cosine:
    """A lobe about the normal whose integral is known: (n + 2) / (2 pi) cos^n theta_v."""

    def evaluate(self, light, view):
        return (32 / (2 * np.pi)) * view[..., 2:] ** 30 * np.ones(3)


class Grain:
    def evaluate(self, light, view):
        return (1 + light[..., :1] ** 2) / np.pi * np.ones_like(light + view)


def test_a_matte_material_gives_back_its_albedo():
    albedos = directional_albedo(Lambert())
    assert [each.incidence_deg for each in albedos] == list(INCIDENCES_DEG)
    for each in albedos:
        assert each.value == pytest.approx((0.2, 0.5, 0.8), rel=1e-12)
        assert each.error < 1e-12


def test_a_lobe_integrates_to_one():
    assert directional_albedo(Cosine())[0].value == pytest.approx((1, 1, 1), rel=1e-6)


def test_azimuths_of_the_light_are_averaged():
    last = directional_albedo(Grain())[-1]
    sine = np.sin(np.radians(75.0))
    assert last.value[0] == pytest.approx(1 + sine**2 / 2, rel=1e-9)


class Lobe:
    """Gaussian in the tilt of the half vector; narrow, it is 8 pi cos^2(incidence) variance."""

    def __init__(self, variance):
        self.variance = variance

    def evaluate(self, light, view):
        half = light + view
        half = half / np.linalg.norm(half, axis=-1, keepdims=True)
        return np.exp(-((1 - half[..., 2:]) / self.variance)) * np.ones(3)


@pytest.mark.parametrize("variance", [1e-4, 1e-6, 1e-7])
def test_narrow_lobes_are_not_missed(variance):
    for incidence in directional_albedo(Lobe(variance))[:5]:
        known = 8 * np.pi * np.cos(np.radians(incidence.incidence_deg)) ** 2 * variance
        assert incidence.value[0] == pytest.approx(known, rel=0.01)
        assert incidence.error < 0.01 * known


def test_the_error_tells_of_lobes_that_the_nodes_miss():
    class Retro:
        def evaluate(self, light, view):
            return np.exp((np.sum(light * view, axis=-1, keepdims=True) - 1) / 1e-4) * np.ones(3)

    coarse = directional_albedo(Retro())[4]
    assert coarse.error > 0.1 * coarse.value[0]
