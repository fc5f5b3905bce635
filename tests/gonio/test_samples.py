import resource
from contextlib import contextmanager
from dataclasses import fields, replace

import h5py
import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gonio.directions import from_degrees
from gonio.errors import BadFileError, BadInputError, StorageError
from gonio.samples import Flag, Samples

DIMENSIONS = {
    "light": ("shot", "xyz"),
    "view": ("shot", "xyz"),
    "value": ("shot", "channel"),
    "sigma": ("shot", "channel"),
    "flag": ("shot", "channel"),
    "light_solid_angle": ("shot",),
    "view_solid_angle": ("shot",),
    "shot_index": ("shot",),
    "attempt": ("shot",),
}


def some(count=3, channels=("r", "g", "b"), **changes):
    rng = np.random.default_rng(count)
    angles = rng.uniform(0, 80, (4, count))
    value = rng.uniform(0.1, 0.5, (count, len(channels)))
    samples = Samples.from_values(
        from_degrees(angles[0], angles[1]), from_degrees(angles[2], angles[3]), value, value / 50,
        channels=channels,
    )  # fmt: skip
    return replace(samples, **changes)


def assert_equal(one, other):
    for field in fields(Samples):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if isinstance(a, np.ndarray):
            np.testing.assert_array_equal(a, b)
            assert a.dtype == b.dtype
        else:
            assert a == b


@st.composite
def any_samples(draw):
    count, channels = draw(st.integers(1, 5)), draw(st.integers(1, 4))
    finite = st.floats(-1e6, 1e6)
    positive = st.floats(0, 1e6) | st.just(np.nan)
    angle = arrays(np.float64, count, elements=st.floats(0, 90))
    names = st.lists(st.text("rgbxyzµ λ0", min_size=1), min_size=channels, max_size=channels)
    return Samples(
        light=from_degrees(draw(angle), draw(angle)),
        view=from_degrees(draw(angle), draw(angle)),
        value=draw(arrays(np.float64, (count, channels), elements=finite)),
        sigma=draw(arrays(np.float64, (count, channels), elements=positive)),
        flag=draw(arrays(np.uint32, (count, channels), elements=st.integers(0, 15))),
        light_solid_angle=draw(arrays(np.float64, count, elements=positive)),
        view_solid_angle=draw(arrays(np.float64, count, elements=positive)),
        shot_index=draw(arrays(np.int64, count, elements=st.integers(0, 2**40))),
        attempt=draw(arrays(np.int64, count, elements=st.integers(1, 99))),
        channels=tuple(draw(names.filter(lambda n: len(set(n)) == len(n)))),
        color_space=draw(st.sampled_from(["linear sRGB", "ACEScg", "spectral"])),
        provenance=draw(
            st.dictionaries(st.sampled_from(["plan", "rig", "journal"]), st.just("a1"))
        ),
        patch_mm=draw(st.none() | st.floats(0.1, 70)),
    )


@given(samples=any_samples())
@settings(max_examples=25, deadline=None)
def test_round_trip(tmp_path_factory, samples):
    path = tmp_path_factory.mktemp("samples") / "samples.nc"
    samples.save(path)
    assert_equal(Samples.load(path), samples)


def test_anyone_with_xarray_can_read_the_file(tmp_path):
    some(provenance={"plan": "ab12"}).save(tmp_path / "samples.nc")
    with xarray.open_dataset(tmp_path / "samples.nc") as dataset:
        assert {name: dataset[name].dims for name in dataset.data_vars} == DIMENSIONS
        assert dict(dataset.sizes) == {"shot": 3, "channel": 3, "xyz": 3}
        assert dataset["channel"].to_numpy().tolist() == ["r", "g", "b"]
        assert dataset.attrs["schema"] == "gonio.samples/1"
        assert dataset.attrs["color_space"] == "linear sRGB"
        assert dataset.attrs["units"] == dataset["value"].attrs["units"] == "sr-1"
        assert dataset["light_solid_angle"].attrs["units"] == "sr"
        assert dataset.attrs["sha256_plan"] == "ab12"
        meanings = dataset["flag"].attrs["flag_meanings"].split()
        masks = dataset["flag"].attrs["flag_masks"]
        assert [Flag[m.upper()].value for m in meanings] == masks.tolist()
        assert np.linalg.norm(dataset["light"], axis=1) == pytest.approx(1.0)


def test_the_same_samples_give_the_same_bytes(tmp_path):
    for name in ("a.nc", "b.nc"):
        some().save(tmp_path / name)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def truncated(path):
    some(200).save(path)
    path.write_bytes(path.read_bytes()[:2000])


def other_schema(path):
    some()._dataset().assign_attrs(schema="x/1").to_netcdf(path, engine="h5netcdf")


def without(name):
    return lambda path: some()._dataset().drop_vars(name).to_netcdf(path, engine="h5netcdf")


def without_color_space(path):
    dataset = some()._dataset()
    del dataset.attrs["color_space"]
    dataset.to_netcdf(path, engine="h5netcdf")


def some_hdf5(path):
    with h5py.File(path, "w") as file:
        file["x"] = [1, 2]


def words_for_values(path):
    dataset = some()._dataset()
    dataset["value"] = (("shot", "channel"), np.full((3, 3), "bright"))
    dataset.to_netcdf(path, engine="h5netcdf")


def words_for_a_patch(path):
    some()._dataset().assign_attrs(patch_mm="wide").to_netcdf(path, engine="h5netcdf")


BAD = [
    # name, what makes the file, what is said
    ("missing", lambda _: None, "no such file"),
    ("a folder", lambda path: path.mkdir(), "no such file"),
    ("empty", lambda path: path.write_bytes(b""), "is not a samples file"),
    ("a text", lambda path: path.write_text("r,g,b\n"), "is not a samples file"),
    ("truncated", truncated, "is not a samples file"),
    ("other schema", other_schema, "has schema 'x/1'"),
    ("other HDF5", some_hdf5, "schema None"),
    ("no value", without("value"), "value: is missing"),
    ("no channel", without("channel"), "channel: is missing"),
    ("no color space", without_color_space, "color_space: is missing"),
    ("words", words_for_values, "value"),
    ("words for the patch", words_for_a_patch, "patch_mm: holds 'wide', no number"),
]


@pytest.mark.parametrize(("make", "says"), [c[1:] for c in BAD], ids=[c[0] for c in BAD])
def test_a_file_that_is_none(tmp_path, make, says):
    path = tmp_path / "samples.nc"
    make(path)
    with pytest.raises(BadFileError) as caught:
        Samples.load(path)
    assert str(caught.value).startswith(str(path))
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


THREE = some()
DOWN = THREE.light * [1, 1, -1]
INCONSISTENT = [
    # name, changes, what is said
    ("too long a vector", {"light": THREE.light * 1.01}, "row 0: light is not a unit vector"),
    ("transmission", {"view": DOWN}, "view points below the sample"),
    ("direction NaN", {"view": THREE.view * np.nan}, "view is not a unit vector"),
    ("value NaN", {"value": np.where(np.eye(3), np.nan, 1.0)}, "value is not finite (and 2 more)"),
    ("sigma negative", {"sigma": -THREE.sigma}, "sigma is negative or infinite"),
    ("sigma infinite", {"sigma": THREE.sigma * np.inf}, "sigma is negative or infinite"),
    ("sigma of no use", {"sigma": THREE.sigma * 1e30}, "row 0: sigma is beyond 1e+12"),
    ("patch of nothing", {"patch_mm": 0.0}, "patch_mm is 0, no positive number"),
    ("rows differ", {"attempt": np.ones(2, np.int64)}, "attempt has shape (2,), not (3,)"),
    ("channels differ", {"channels": ("y",)}, "value has shape (3, 3), not (3, 1)"),
]


@pytest.mark.parametrize(
    ("changes", "says"), [c[1:] for c in INCONSISTENT], ids=[c[0] for c in INCONSISTENT]
)
def test_samples_that_no_estimator_can_use(changes, says):
    with pytest.raises(BadInputError) as caught:
        replace(THREE, **changes).check()
    assert says in str(caught.value)


def test_unknown_sigma_is_flagged():
    samples = Samples.from_values(THREE.light, THREE.view, THREE.value)
    assert np.isnan(samples.sigma).all()
    assert (samples.flag == Flag.NO_SIGMA).all()
    assert not (THREE.flag & Flag.NO_SIGMA).any()


def test_white_is_four_medians():
    assert THREE.white == pytest.approx(4 * np.median(THREE.value))


@pytest.mark.parametrize(
    ("samples", "says"),
    [(some(0), "there are no samples"), (some(value=np.zeros((3, 3))), "no scale")],
    ids=["none", "black"],
)
def test_samples_without_a_scale(samples, says):
    with pytest.raises(BadInputError, match=says):
        _ = samples.white


@contextmanager
def files_no_larger_than(limit):
    """Let the operating system refuse larger files, as a full disk would."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_write_that_is_refused_leaves_the_old_file_and_no_noise(tmp_path, capfd):
    path = tmp_path / "samples.nc"
    some().save(path)
    old = path.read_bytes()
    with files_no_larger_than(30_000), pytest.raises(StorageError, match=r"samples\.nc: cannot"):
        some(2000).save(path)
    assert path.read_bytes() == old
    assert [p.name for p in tmp_path.iterdir()] == ["samples.nc"]
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(("suspect", "kept"), [([], [0, 1, 2, 3]), ([2], [0, 1, 3]),
                                               ([0, 1], [0, 1, 2, 3])])  # fmt: skip
def test_suspect_shots_are_left_out_unless_half_are(suspect, kept):
    samples = some(4)
    part = {"photon": samples.sigma / 2}
    samples.flag[suspect] |= np.uint32(Flag.SUSPECT)
    trusted = replace(samples, components=part).trusted()
    assert trusted.shot_index.tolist() == kept
    np.testing.assert_array_equal(trusted.value, samples.value[kept])
    np.testing.assert_array_equal(trusted.components["photon"], part["photon"][kept])
    trusted.check()
