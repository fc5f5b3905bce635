"""RGL's tensors: written and read as Mitsuba reads them, and refused where broken."""

import os
import struct

import numpy as np
import pytest

from gonio.directions import from_spherical
from gonio.errors import BadFileError
from gonio.exchange import read_material, rgl_writing
from gonio.exchange.format import Source
from gonio.exchange.rgl import write
from gonio.exchange.tensor_file import pack, unpack
from gonio.exchange.warp import Warp, alone
from nnbrdf.analytic import AnisotropicGGX, Fibers, Lambert, Sum
from sim.materials import EMBEDDED

# grooves along +x, and highlights that are not where a mirror has them
_TILTED = Sum((Lambert((0.3, 0.2, 0.1)), Fibers((0.1, 0.05, 0.02), width=0.3, tilt=0.2)))
_GROOVED = Sum((Lambert((0.1, 0.1, 0.1)), AnisotropicGGX((0.5, 0.4, 0.3), 0.2, 0.5)))
_EVEN = EMBEDDED["gold-leaf"].material
_GLOSSY = EMBEDDED["glossy-plastic"].material


@pytest.fixture(scope="module")
def tensors(tmp_path_factory):
    """Write small tensors: of two even materials, and of two with a grain."""
    folder = tmp_path_factory.mktemp("rgl")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rgl_writing, "_NODES", 24)
        patch.setattr(rgl_writing, "_PHI_STEP_DEG", 15.0)
        patch.setattr(rgl_writing, "_FINE_NODES", 40)
        materials = {"even": _EVEN, "glossy": _GLOSSY, "tilted": _TILTED, "grooved": _GROOVED}
        for name, material in materials.items():
            # the name of a file need not be text
            write(Source(material, os.fsdecode(b"\xff") + name), folder / f"{name}.bsdf", None)
    return folder


@pytest.fixture(scope="module")
def pairs():
    random = np.random.default_rng(5)
    theta = np.arccos(random.uniform(np.cos(np.radians(75)), 1, (2, 150)))
    return from_spherical(theta, random.uniform(0, 2 * np.pi, (2, 150)))


@pytest.fixture(scope="module")
def mitsuba():
    module = pytest.importorskip("mitsuba")
    module.set_variant("scalar_rgb")
    return module


def _in_mitsuba(mitsuba, path, light, view):
    """Return what Mitsuba makes of a file: it evaluates f cos theta of the second direction."""
    bsdf = mitsuba.load_dict({"type": "measured", "filename": str(path)})
    surface, told = mitsuba.SurfaceInteraction3f(), []
    for incident, exitant in zip(light, view, strict=True):
        surface.wi = mitsuba.Vector3f(*incident)
        told.append(np.array(bsdf.eval(mitsuba.BSDFContext(), surface, mitsuba.Vector3f(*exitant))))
    return np.array(told) / view[:, 2:]


@pytest.mark.parametrize(
    ("name", "material", "error"),
    [("even", _EVEN, 0.005), ("tilted", _TILTED, 0.01), ("grooved", _GROOVED, 0.03)],
)
def test_mitsuba_reads_the_material(tensors, pairs, mitsuba, name, material, error):
    told = _in_mitsuba(mitsuba, tensors / f"{name}.bsdf", *pairs)
    true = material.evaluate(*pairs)
    assert np.abs(told - true).mean() < error * true.mean()
    np.testing.assert_allclose(
        read_material(tensors / f"{name}.bsdf").evaluate(*pairs), told, rtol=1e-3, atol=1e-5
    )


@pytest.mark.parametrize(("kept", "symmetry"), [(0.5, 2), (0.25, 4)])
def test_azimuths_that_mirrors_stand_for(tensors, pairs, mitsuba, tmp_path, kept, symmetry):
    whole = tensors / "grooved.bsdf"
    fields = unpack(whole.read_bytes(), whole)
    count = round(kept * (len(fields["phi_i"]) - 1)) + 1
    for name in ("phi_i", "vndf", "luminance", "rgb"):
        fields[name] = fields[name][:count]
    path = tmp_path / "part.bsdf"
    path.write_bytes(pack(fields))
    part = read_material(path)
    assert part.symmetry == symmetry
    told = _in_mitsuba(mitsuba, path, *pairs)
    np.testing.assert_allclose(part.evaluate(*pairs), told, rtol=1e-3, atol=1e-5)
    true = read_material(whole).evaluate(*pairs)
    assert np.abs(told - true).mean() < 0.01 * true.mean()


def test_mitsuba_samples_what_it_evaluates(tensors, mitsuba):
    path = tensors / "tilted.bsdf"
    bsdf = mitsuba.load_dict({"type": "measured", "filename": str(path)})
    surface, context = mitsuba.SurfaceInteraction3f(), mitsuba.BSDFContext()
    light = from_spherical(0.7, 1.1)
    surface.wi = mitsuba.Vector3f(*light)
    random = np.random.default_rng(2)
    draws = [
        bsdf.sample(context, surface, 0.5, mitsuba.Point2f(*random.random(2)))[1]
        for _ in range(2000)
    ]
    weights = np.array(draws)
    # the hemisphere by its own quadrature, uniform in cos^2 theta
    u, v = (np.arange(60) + 0.5) / 60, (np.arange(90) + 0.5) / 90
    view = from_spherical(np.arccos(np.sqrt(u))[:, None], 2 * np.pi * v)
    albedo = np.pi * read_material(path).evaluate(light, view).mean(axis=(0, 1))
    np.testing.assert_allclose(weights.mean(axis=0), albedo, rtol=0.02)
    # and it samples well: weights hardly vary
    assert weights[:, 1].std() < 0.3 * weights[:, 1].mean()


@pytest.mark.parametrize("theta_deg", [80, 86])
@pytest.mark.parametrize(("name", "material"), [("even", _EVEN), ("glossy", _GLOSSY)])
def test_a_grazing_light_is_sent_back_by_no_less_than_nothing(
    tensors, mitsuba, name, material, theta_deg
):
    bsdf = mitsuba.load_dict({"type": "measured", "filename": str(tensors / f"{name}.bsdf")})
    surface, context = mitsuba.SurfaceInteraction3f(), mitsuba.BSDFContext()
    light = from_spherical(np.radians(theta_deg), 0.4)
    surface.wi = mitsuba.Vector3f(*light)
    middle = (np.arange(16) + 0.5) / 16
    draws = [bsdf.sample(context, surface, 0.5, mitsuba.Point2f(x, y))[1]
             for x in middle for y in middle]  # fmt: skip
    weights = np.array(draws)
    assert (weights >= 0).all()
    # finer than the highlight
    u, v = (np.arange(300) + 0.5) / 300, (np.arange(400) + 0.5) / 400
    view = from_spherical(np.arccos(np.sqrt(u))[:, None], 2 * np.pi * v)
    albedo = np.pi * material.evaluate(light, view).mean(axis=(0, 1))
    np.testing.assert_allclose(weights.mean(axis=0), albedo, rtol=0.15)


def test_tensors_of_the_database(measured, pairs, mitsuba):
    paths = sorted(measured.glob("*_rgb.bsdf"))
    assert paths
    for path in paths:
        told = _in_mitsuba(mitsuba, path, *pairs)
        # out of gamut, the files hold negative values
        told = told.clip(0)
        np.testing.assert_allclose(
            read_material(path).evaluate(*pairs), told, rtol=1e-3, atol=1e-5 * told.max()
        )


def test_nodes_come_back_from_where_they_went():
    random = np.random.default_rng(1)
    density = random.random((2, 7, 9)) ** 3
    density[0, :, :3] = 0
    warp = Warp(density)
    wanted = np.linspace(0, 1, 12)
    for index in (0, 1):
        nodes = warp.nodes(index, 12).reshape(-1, 2)
        place, _ = warp.invert(nodes, alone(np.full(len(nodes), index)))
        expected = np.stack(np.meshgrid(wanted, wanted), axis=-1).reshape(-1, 2)
        np.testing.assert_allclose(place, expected, atol=1e-9)


def _header(*fields: bytes, count: int | None = None) -> bytes:
    number = len(fields) if count is None else count
    return b"tensor_file\0\x01\x00" + struct.pack("<I", number) + b"".join(fields)


def _field(name: bytes, kind: int, offset: int, *shape: int) -> bytes:
    head = struct.pack("<H", len(name)) + name + struct.pack("<HBQ", len(shape), kind, offset)
    return head + struct.pack(f"<{len(shape)}Q", *shape)


BROKEN = {
    "version": (b"tensor_file\0\x02\x00\0\0\0\0", "does not begin as"),
    "cut": (_header()[:15], "broken header"),
    "fields": (_header(count=2**32 - 1), "tells of 4294967295 fields"),
    "huge": (_header(_field(b"rgb", 10, 0, 2**63, 2**63)), "'rgb' ends beyond the file"),
    "far": (_header(_field(b"rgb", 10, 2**63, 1)), "'rgb' ends beyond the file"),
    "type": (_header(_field(b"rgb", 12, 0, 1)), "unknown type 12"),
    "lines": (_header(_field(b"\n\x1b[2J", 12, 0, 1)), r"'\\n\\x1b\[2J' is of unknown type"),
    "name": (_header(_field(b"\xff", 10, 0, 1)), "broken header"),
    "empty": (_header(), "has no field phi_i"),
    "none": (_header(_field(b"phi_i", 10, 0, 0)), r"phi_i is of shape \(0,\)"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_one_line(name, tmp_path):
    content, says = BROKEN[name]
    path = tmp_path / f"{name}.bsdf"
    path.write_bytes(content)
    with pytest.raises(BadFileError, match=says):
        read_material(path)


SPOILED = {
    "nan": ("rgb", lambda a: a * np.nan, "rgb holds"),
    # NumPy warns of such when it casts them
    "signalling": ("rgb", lambda a: (0 * a.view("<u4") + 0x7FA00000).view("<f4"), "rgb holds"),
    "negative": ("vndf", lambda a: -a, "vndf is negative"),
    "order": ("theta_i", lambda a: a[::-1], "theta_i does not grow"),
    "fit": ("theta_i", lambda a: a[1:], "do not fit"),
    "flat": ("rgb", lambda a: a[0], "rgb is of shape"),
}


@pytest.mark.parametrize("name", SPOILED)
def test_a_spoiled_field_is_one_line(name, tensors, tmp_path):
    field, spoil, says = SPOILED[name]
    source = tensors / "even.bsdf"
    fields = unpack(source.read_bytes(), source)
    fields[field] = np.ascontiguousarray(spoil(fields[field]))
    path = tmp_path / f"{name}.bsdf"
    path.write_bytes(pack(fields))
    with pytest.raises(BadFileError, match=says):
        read_material(path)


AZIMUTHS = {
    "sixth": np.linspace(0.0, np.pi / 3, 3),
    "endless": np.array([0.0, 1.0, 1e4]),
    "nothing": np.array([0.0, 1e-310, 2e-310]),
}


@pytest.mark.parametrize("name", AZIMUTHS)
def test_azimuths_that_no_mirrors_stand_for_are_refused(name, tensors, tmp_path):
    source = tensors / "grooved.bsdf"
    fields = unpack(source.read_bytes(), source)
    for field in ("vndf", "luminance", "rgb"):
        fields[field] = fields[field][:3]
    path = tmp_path / f"{name}.bsdf"
    path.write_bytes(pack(fields | {"phi_i": AZIMUTHS[name]}))
    with pytest.raises(BadFileError, match="phi_i is over no whole, half or quarter turn"):
        read_material(path)


def test_a_black_slice_is_dark_and_no_crash(tensors, pairs, tmp_path):
    source = tensors / "even.bsdf"
    fields = unpack(source.read_bytes(), source)
    fields["vndf"] = np.zeros_like(fields["vndf"])
    path = tmp_path / "black.bsdf"
    path.write_bytes(pack(fields))
    assert np.isfinite(read_material(path).evaluate(*pairs)).all()
