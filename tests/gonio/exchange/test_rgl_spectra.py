"""RGL's tensors of spectra: colours as Mitsuba sees them, and broken ones refused."""

import sys

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.cli import _main
from gonio.directions import from_spherical
from gonio.errors import BadFileError, MissingExtraError
from gonio.exchange import read_material, rgl_writing
from gonio.exchange.format import Source
from gonio.exchange.rgl import write
from gonio.exchange.spectra import srgb_weights
from gonio.exchange.tensor_file import pack, unpack
from sim.materials import EMBEDDED

pytest.importorskip("colour")

_NM = np.arange(380.0, 781.0, 10.0)
_SRGB_FROM_XYZ = np.linalg.inv(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175],
     [0.0193339, 0.119192, 0.9503041]]
)  # fmt: skip


@pytest.fixture(scope="module")
def fields(tmp_path_factory):
    """Return the fields of a small tensor whose red, green and blue are bands of wavelengths."""
    path = tmp_path_factory.mktemp("rgl") / "gold.bsdf"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rgl_writing, "_FINE_NODES", 16)
        patch.setattr(rgl_writing, "_DENSITY_SIZE", 24)
        write(Source(EMBEDDED["gold-leaf"].material, "gold"), path, None)
    fields = unpack(path.read_bytes(), path)
    bands = np.exp(-(((_NM[:, None] - [620, 540, 450]) / 40) ** 2))
    spectra = np.einsum("wc,ptcyx->ptwyx", bands, fields.pop("rgb"))
    return fields | {"wavelengths": _NM.astype("<f4"), "spectra": spectra.astype("<f4")}


@pytest.fixture(scope="module")
def tensor(fields, tmp_path_factory):
    path = tmp_path_factory.mktemp("spectra") / "gold_spec.bsdf"
    path.write_bytes(pack(fields))
    return path


@pytest.fixture(scope="module")
def pairs():
    random = np.random.default_rng(7)
    theta = np.arccos(random.uniform(np.cos(np.radians(75)), 1, (2, 30)))
    return from_spherical(theta, random.uniform(0, 2 * np.pi, (2, 30)))


def _seen_by_mitsuba(mitsuba, path, light, view):
    """Return linear sRGB under D65 by Mitsuba's own spectra, observer and lamp, every 4 nm."""
    bsdf = mitsuba.load_dict({"type": "measured", "filename": str(path)})
    lamp = mitsuba.load_dict({"type": "d65"})
    surface, context = mitsuba.SurfaceInteraction3f(), mitsuba.BSDFContext()
    seen, white = np.zeros((len(light), 3)), np.zeros(3)
    for four in np.arange(360.0, 776.0, 4.0).reshape(-1, 4):
        surface.wavelengths = mitsuba.Spectrum(*four)
        xyz = np.array([mitsuba.cie1931_xyz(each) for each in four])
        weights = np.array(lamp.eval(surface))[:, None] * xyz
        white += weights.sum(axis=0)
        for i, (incident, exitant) in enumerate(zip(light, view, strict=True)):
            surface.wi = mitsuba.Vector3f(*incident)
            told = bsdf.eval(context, surface, mitsuba.Vector3f(*exitant))
            seen[i] += np.array(told) @ weights
    return seen / white[1] @ _SRGB_FROM_XYZ.T / view[:, 2:]


def test_colours_are_those_that_mitsuba_sees(tensor, pairs):
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    with mitsuba.variant_context("scalar_spectral"):
        seen = _seen_by_mitsuba(mitsuba, tensor, *pairs)
    told = read_material(tensor).evaluate(*pairs)
    np.testing.assert_allclose(told, seen, rtol=0.001)


def test_a_grey_reflectance_is_grey():
    np.testing.assert_allclose(srgb_weights(_NM).sum(axis=0), 1.0, atol=1e-6)


def test_a_tensor_of_spectra_is_imported(tensor, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(_main.cli, ["import", str(tensor)])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "gold_spec.npz").is_file()


SPOILED = {
    "none": ("wavelengths", lambda a: None, "no field wavelengths"),
    "few": ("wavelengths", lambda a: a[:1], r"wavelengths is of shape \(1,\)"),
    "many": ("wavelengths", lambda a: np.arange(4096.0), r"wavelengths is of shape \(4096,\)"),
    "hostile": ("wavelengths", lambda a: np.arange(5e4), r"wavelengths is of shape \(50000,\)"),
    "nan": ("wavelengths", lambda a: a * np.nan, "wavelengths does not grow"),
    "endless": ("wavelengths", lambda a: np.where(a > 500, np.inf, a), "wavelengths does not grow"),
    "order": ("wavelengths", lambda a: a[::-1], "wavelengths does not grow"),
    "infrared": ("wavelengths", lambda a: a + 100, "do not reach from 400 to 700 nm"),
    "fit": ("spectra", lambda a: a[:, :, 1:], "is of shape"),
    "flat": ("spectra", lambda a: a[0], "is of shape"),
    "empty": ("spectra", lambda a: a[:0], "is of shape"),
    "dark": ("spectra", lambda a: a * np.nan, "rgb holds"),
    "bright": ("spectra", lambda a: a * np.inf, "rgb holds"),
}


@pytest.mark.parametrize("name", SPOILED)
def test_spoiled_spectra_are_one_line(name, fields, tmp_path):
    field, spoil, says = SPOILED[name]
    with np.errstate(invalid="ignore"):
        spoiled = fields | {field: spoil(fields[field])}
    path = tmp_path / "spoiled.bsdf"
    path.write_bytes(
        pack({k: np.ascontiguousarray(a) for k, a in spoiled.items() if a is not None})
    )
    with pytest.raises(BadFileError, match=says):
        read_material(path)


def test_a_tensor_of_too_many_values_is_refused_before_they_are_made(fields, tmp_path, monkeypatch):
    monkeypatch.setattr("gonio.exchange.rgl._MOST_VALUES", 10_000)
    path = tmp_path / "many.bsdf"
    path.write_bytes(pack(fields))
    with pytest.raises(BadFileError, match="rgb would hold more than 10000 values"):
        read_material(path)


def test_without_the_observers_the_extra_is_named(tensor, monkeypatch):
    monkeypatch.setitem(sys.modules, "colour", None)
    with pytest.raises(MissingExtraError, match=r"gonio\[color\]"):
        read_material(tensor)
