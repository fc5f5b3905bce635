"""Single causes of uncertainty, each against what it does to a value when it truly errs."""

import numpy as np
import pytest

from gonio.calibration import Linearity
from gonio.directions import from_degrees
from gonio.materials import Lambertian
from gonio.reduce.causes import Causes
from gonio.reduce.color import Coloring
from gonio.reduce.doubt import Doubt
from gonio.reduce.merge import merge
from gonio.reduce.reading import Reading
from gonio.reduce.white import respond

RANGE = 60_000.0
EVEN = np.ones(11)
BEND = (0.0, 0.05, 0.0, 0.08)
ERROR = (0.01, 0.0, -0.02, 0.03)


def bent(coefficients):
    return Linearity(
        coefficients=coefficients, raw_range=RANGE, reach=0.8, deviation=0.0, left=0.0,
    )  # fmt: skip


def reading(as_read, *, linearity=None, exposure_s=1.0, flux=EVEN):
    as_read = np.full(3, float(as_read))
    return Reading(
        signal=linearity.undo(as_read) if linearity else as_read,
        as_read=as_read, exposure=np.full(3, exposure_s), pixels=np.full(3, 30),
        saturated=np.zeros(3, np.bool_), read_variance=10.0, dark_variance=2.5,
        surround=np.zeros(3), stray=np.zeros(3), light=from_degrees(0, 0),
        view=from_degrees(45, 0), arms_rad=np.zeros(4), light_solid_angle=0.0,
        view_solid_angle=0.0, flux=np.array(flux),
    )  # fmt: skip


def measured(samples, whites, doubt=None):
    """Return the values of samples of one reading each, and what errs in them."""
    coloring = Coloring("linear sRGB", "test", np.eye(3), np.eye(3))
    response = respond(whites, 1.0, Lambertian(0.99), coloring)
    rates = [merge([each], 1.0) for each in samples]
    value = np.array([response.brdf(rate) for rate in rates])
    return value, Causes(response, value, rates, [[each] for each in samples], doubt or Doubt())


@pytest.mark.parametrize("raw", [6e3, 3e4, 5.7e4])
def test_linearity_errs_where_the_sensor_was_read(raw):
    true, off = (bent(tuple(each)) for each in (BEND, np.add(BEND, ERROR)))
    doubt = Doubt(bends=np.array([ERROR]), raw_range=RANGE, reach=true.reach)
    value, causes = measured([reading(raw, linearity=true)], [reading(2e4, linearity=true)], doubt)
    shifted, _ = measured([reading(raw, linearity=off)], [reading(2e4, linearity=off)])
    np.testing.assert_allclose(causes.calibration(), np.abs(shifted - value), rtol=0.02)


def fading(flux, white=EVEN):
    _, causes = measured([reading(1e4, flux=flux)], [reading(1e4, flux=white)])
    return causes.fading()[0]


def test_a_lamp_that_fades_while_another_brightens_is_seen():
    assert fading(EVEN) == 0.0
    assert fading(np.full(11, 0.9)) == pytest.approx(-np.log(0.9))
    opposed = np.array([0.9, 1.1, *(1.0,) * 9])
    assert opposed.mean() == 1.0
    assert fading(opposed) == pytest.approx((0.9 * -np.log(0.9) + 1.1 * np.log(1.1)) / 11)


def test_a_lamp_that_was_dark_for_the_white_is_compared_with_the_others():
    first, second = np.eye(11)[:2]
    assert fading(0.9 * second, white=first) == pytest.approx(-np.log(0.9))
