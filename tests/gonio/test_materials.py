import io
import math
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_spherical, normalize, paper_directions
from gonio.errors import BadFileError
from gonio.materials import Lambertian, MeasuredTable, SphericalMesh, reference_material
from gonio.rig import default_rig

NODES = paper_directions()
RIM = math.radians(75.0)
TABLE = MeasuredTable.of(np.random.default_rng(4).uniform(0.05, 2.0, (81, 81, 3)))
MESH = SphericalMesh(NODES)

THETA = st.floats(0.0, math.pi / 2)
PHI = st.floats(0.0, 2 * math.pi)
DIRECTION = st.builds(from_spherical, THETA, PHI)


def test_the_table_is_exact_at_the_nodes():
    found = TABLE.evaluate(NODES[:, None], NODES[None])
    np.testing.assert_allclose(found, TABLE.values, rtol=0, atol=1e-9)


@given(DIRECTION)
def test_weights_are_a_partition_of_unity_of_three_nodes(direction):
    nodes, weights = MESH.locate(direction)
    assert weights.sum() == pytest.approx(1.0, abs=1e-12)
    assert (weights >= 0).all()
    assert len(set(nodes.tolist())) == 3


@given(theta=st.floats(0.0, RIM - 1e-9), phi=PHI)
def test_weights_find_the_direction_again(theta, phi):
    direction = from_spherical(theta, phi)
    nodes, weights = MESH.locate(direction)
    found = normalize(weights @ NODES[nodes])
    # great circles between the rim's nodes, 15 deg apart, run up to 0.12 deg inside the rim
    tolerance = 1e-9 if theta < math.radians(74.87) else math.radians(0.13)
    np.testing.assert_allclose(found, direction, atol=tolerance)


@given(light=DIRECTION, view=DIRECTION, turn=st.floats(0, 2 * math.pi))
def test_the_table_is_continuous(light, view, turn):
    """A small step changes the value by no more than the steepest slope between nodes allows."""
    step = 1e-6 * np.array([math.cos(turn), math.sin(turn), 0.0])
    near = normalize(light + step)
    if near[2] >= 0:
        change = np.abs(TABLE.evaluate(near, view) - TABLE.evaluate(light, view))
        assert change.max() < 2.0 * 1e-6 / math.radians(3)


@given(theta=st.floats(RIM, math.pi / 2), phi=PHI, view=DIRECTION)
def test_beyond_the_rim_theta_is_clamped(theta, phi, view):
    inside = TABLE.evaluate(from_spherical(RIM, phi), view)
    np.testing.assert_allclose(TABLE.evaluate(from_spherical(theta, phi), view), inside, atol=1e-9)
    np.testing.assert_allclose(
        TABLE.evaluate(view, from_spherical(theta, phi)),
        TABLE.evaluate(view, from_spherical(RIM, phi)),
        atol=1e-9,
    )


@given(light=DIRECTION, view=DIRECTION)
def test_values_stay_within_the_tables(light, view):
    value = TABLE.evaluate(light, view)
    assert (value >= TABLE.values.min(axis=(0, 1)) - 1e-12).all()
    assert (value <= TABLE.values.max(axis=(0, 1)) + 1e-12).all()


def test_a_constant_table_is_constant_everywhere():
    rng = np.random.default_rng(0)
    light, view = (from_spherical(rng.uniform(0, 1.5, 500), rng.uniform(0, 6, 500)) for _ in "lv")
    flat = MeasuredTable.of(np.full((81, 81, 3), 0.25))
    np.testing.assert_allclose(flat.evaluate(light, view), 0.25, rtol=1e-12)


def test_one_call_and_many_agree():
    """Faces far from all directions of a call are not searched; which ones must not matter."""
    rng = np.random.default_rng(1)
    light, view = (from_spherical(rng.uniform(0, 1.5, 40), rng.uniform(0, 6, 40)) for _ in "lv")
    together = TABLE.evaluate(light, view)
    one_by_one = [TABLE.evaluate(a, b) for a, b in zip(light, view, strict=True)]
    np.testing.assert_allclose(together, one_by_one, atol=1e-12)
    grid = TABLE.evaluate(light[:, None], view[None])
    np.testing.assert_allclose(np.einsum("iic->ic", grid), together, atol=1e-12)


def test_round_trip(tmp_path):
    TABLE.save(tmp_path / "t.npz")
    back = MeasuredTable.load(tmp_path / "t.npz")
    np.testing.assert_array_equal(back.values, TABLE.values)
    assert back.white == TABLE.white == 4 * np.median(TABLE.values)
    with np.load(tmp_path / "t.npz", allow_pickle=False) as arrays:
        np.testing.assert_array_equal(arrays["directions"], NODES)


def test_without_a_stated_white_it_is_four_medians(tmp_path):
    np.savez(tmp_path / "t.npz", values=TABLE.values)
    assert MeasuredTable.load(tmp_path / "t.npz").white == TABLE.white


def npz(write=np.savez, **arrays):
    file = io.BytesIO()
    write(file, **arrays)
    return file.getvalue()


def zipped(name, content):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr(name, content)
    return file.getvalue()


GOOD = npz(values=TABLE.values, white=1.0)
PACKED = npz(np.savez_compressed, values=TABLE.values)
ONES = np.ones((81, 81, 3))


def with_value(value):
    values = ONES.copy()
    values[7, 3, 1] = value
    return values


BAD = [
    # name, content (None: no file), what is said
    ("missing", None, "no such file"),
    ("empty", b"", "is not a table"),
    ("a text", b"values: 1, 2, 3", "is not a table"),
    ("truncated", GOOD[: len(GOOD) // 2], "is not a table"),
    ("damaged", GOOD[:500] + b"\0" * 1000 + GOOD[1500:], "is not a table"),
    ("damaged within", PACKED[:20_000] + b"\0" * 1000 + PACKED[21_000:], "is not a table"),
    ("another zip", zipped("readme.txt", b"hello"), "lacks an array"),
    ("no array inside", zipped("values.npy", b"hello"), "is not a table"),
    ("no values", npz(white=1.0), "lacks an array (values"),
    ("wrong shape", npz(values=ONES[:80]), "values has shape (80, 81, 3)"),
    ("a scalar", npz(values=1.0), "values has shape ()"),
    ("words", npz(values=np.full((81, 81, 3), "a")), "is not a table"),
    ("complex", npz(values=ONES * 1j), "is not a table"),
    ("pickle", npz(values=np.array([{}], dtype=object)), "is not a table"),
    (
        "negative",
        npz(values=with_value(-0.5)),
        "values[7, 3, 1] (light, view, channel) is -0.5, negative; expected",
    ),
    (
        "not finite",
        npz(values=ONES * np.nan),
        "values[0, 0, 0] (light, view, channel) is nan, not finite; in all, 19683 values are no",
    ),
    (
        "below everything",
        npz(values=with_value(-np.inf)),
        "values[7, 3, 1] (light, view, channel) is -inf, not finite; expected",
    ),
    ("black", npz(values=0 * ONES), "has no white, and 4 x the median of its values"),
    ("black by white", npz(values=ONES, white=0.0), "white is 0, no positive number"),
    ("white NaN", npz(values=ONES, white=np.nan), "white is nan"),
    ("white infinite", npz(values=ONES, white=np.inf), "white is inf"),
    ("many whites", npz(values=ONES, white=np.ones(2)), "is not a table"),
    (
        "one array alone",
        (lambda f: (np.save(f, ONES), f.getvalue())[1])(io.BytesIO()),
        "not a table",
    ),
]


@pytest.mark.parametrize(("content", "says"), [c[1:] for c in BAD], ids=[c[0] for c in BAD])
def test_a_file_that_is_no_table(tmp_path, content, says):
    path = tmp_path / "t.npz"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(BadFileError) as caught:
        MeasuredTable.load(path)
    assert str(caught.value).startswith(str(path))
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


class Intruder:
    """Makes a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (Path.touch, (self.path,))


def test_nothing_is_unpickled(tmp_path):
    np.savez(tmp_path / "t.npz", values=np.array([Intruder(tmp_path / "trace")], dtype=object))
    with pytest.raises(BadFileError, match="is not a table"):
        MeasuredTable.load(tmp_path / "t.npz")
    assert not (tmp_path / "trace").exists()


def test_a_folder_is_no_table(tmp_path):
    with pytest.raises(BadFileError, match="is not a table"):
        MeasuredTable.load(tmp_path)


def test_the_white_reference_is_a_factor_or_a_file(tmp_path):
    rig = default_rig()
    assert reference_material(rig) == Lambertian(0.99)
    np.testing.assert_allclose(
        reference_material(rig).evaluate(NODES[:, None], NODES[:2]), 0.99 / math.pi
    )
    TABLE.save(tmp_path / "white.npz")
    holder = rig.holder.model_copy(update={"reference": str(tmp_path / "white.npz")})
    found = reference_material(rig.model_copy(update={"holder": holder}))
    np.testing.assert_array_equal(found.values, TABLE.values)


@pytest.mark.measured
def test_measured_materials_load_and_are_exact_at_the_nodes(measured):
    path = measured / "ubo2014_felt05.npz"
    table = MeasuredTable.load(path)
    with np.load(path) as arrays:
        np.testing.assert_allclose(
            table.evaluate(NODES[:, None], NODES[None]), arrays["values"], atol=1e-9
        )
        assert table.white == float(arrays["white"])
