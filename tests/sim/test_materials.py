import numpy as np
import pytest

from gonio.directions import from_degrees, paper_directions
from gonio.errors import BadFileError, BadInputError
from gonio.materials import MeasuredTable
from sim.materials import EMBEDDED, anisotropy, load_material
from sim.truth import write_truth

each_material = pytest.mark.parametrize("name", EMBEDDED)
ANISOTROPIC = {"wood-veneer", "woven-cloth", "brushed-metal", "satin"}


def grid(material):
    directions = paper_directions()
    return material.evaluate(directions[:, None], directions)


@each_material
def test_is_reciprocal_finite_and_not_black(name):
    value = grid(load_material(name))
    assert np.isfinite(value).all()
    assert (value > 0).all()
    np.testing.assert_allclose(value, value.swapaxes(0, 1), rtol=1e-9)


@each_material
def test_is_anisotropic_as_it_should_be(name):
    change = anisotropy(load_material(name))
    assert (change > 0.1) if name in ANISOTROPIC else (change < 1e-9)


def test_what_has_to_be_there():
    wanted = {"wood-veneer", "woven-cloth", "brushed-metal", "satin", "matte-paint", "near-mirror"}
    assert wanted <= EMBEDDED.keys()
    assert len(EMBEDDED) >= 8


def test_the_near_mirror_is_dark_with_one_narrow_highlight():
    value = load_material("near-mirror").evaluate(
        from_degrees(45, 0), from_degrees([45, 45, 45], [180, 170, 0])
    )
    assert value[0, 1] > 50 * value[1, 1] > 50 * value[2, 1] / 10
    assert value[2, 1] < 0.01


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(BadInputError) as caught:
        load_material("wood")
    message = str(caught.value)
    assert all(name in message for name in EMBEDDED)
    assert ".npz" in message
    assert "\n" not in message


def test_a_path_is_a_measured_table(tmp_path):
    values = np.random.default_rng(2).random((81, 81, 3))
    MeasuredTable(values, 0.7).save(tmp_path / "mine.npz")
    loaded = load_material(str(tmp_path / "mine.npz"))
    np.testing.assert_allclose(grid(loaded), values, rtol=1e-9)
    with pytest.raises(BadFileError, match=r"none\.npz: no such file"):
        load_material(str(tmp_path / "none.npz"))


@each_material
def test_truth_is_the_material_on_the_grid(name, tmp_path):
    write_truth(tmp_path / "truth.npz", load_material(name))
    truth = MeasuredTable.load(tmp_path / "truth.npz")
    expected = grid(load_material(name))
    np.testing.assert_array_equal(truth.values, expected)
    assert truth.white == 4 * np.median(expected) > 0


def test_truth_of_a_table_keeps_its_white(tmp_path):
    values = np.random.default_rng(3).random((81, 81, 3))
    write_truth(tmp_path / "truth.npz", MeasuredTable(values, 0.123))
    truth = MeasuredTable.load(tmp_path / "truth.npz")
    np.testing.assert_array_equal(truth.values, values)
    assert truth.white == 0.123
