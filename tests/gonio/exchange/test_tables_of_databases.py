"""MERL's and UTIA's tables: written, read as their own readers do, and refused where broken."""

import struct

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.api.opened import open_material
from gonio.cli import _main
from gonio.directions import from_degrees, from_spherical, to_half_difference
from gonio.errors import BadFileError
from gonio.exchange import read_material
from gonio.exchange.format import Source
from gonio.exchange.merl import write as write_merl
from gonio.exchange.utia import write as write_utia
from nnbrdf.analytic import Fibers, Lambert, Sum
from sim.materials import EMBEDDED, load_material

_SCALE = np.array([1.0, 1.15, 1.66]) / 1500
_TILTED = Sum((Lambert((0.3, 0.2, 0.1)), Fibers((0.1, 0.05, 0.02), width=0.3, tilt=0.2)))


@pytest.fixture(scope="module")
def gold(tmp_path_factory):
    path = tmp_path_factory.mktemp("merl") / "gold.binary"
    write_merl(Source(EMBEDDED["gold-leaf"].material, "gold"), path, None)
    return path


@pytest.fixture(scope="module")
def tilted(tmp_path_factory):
    path = tmp_path_factory.mktemp("utia") / "tilted.bin"
    write_utia(Source(_TILTED, "tilted"), path, None)
    return path


@pytest.fixture(scope="module")
def pairs():
    random = np.random.default_rng(3)
    theta = np.arccos(random.uniform(np.cos(np.radians(70)), 1, (2, 300)))
    return from_spherical(theta, random.uniform(0, 2 * np.pi, (2, 300)))


def _nearest_cell(path, light, view):
    """Look a value up as the code of MERL's own page does, by the cell that it falls into."""
    content = path.read_bytes()
    half, difference, turn = struct.unpack("<3i", content[:12])
    planes = np.frombuffer(content, "<f8", offset=12).reshape(3, -1)
    theta_h, _, theta_d, phi_d = to_half_difference(light, view)
    row = np.minimum((np.sqrt(theta_h / (np.pi / 2)) * half).astype(int), half - 1)
    column = np.minimum((theta_d / (np.pi / 2) * difference).astype(int), difference - 1)
    cell = np.minimum((phi_d % np.pi / np.pi * turn).astype(int), turn - 1)
    return planes[:, (row * difference + column) * turn + cell].T * _SCALE


def test_merl_is_as_its_own_code_looks_it_up(gold, pairs):
    true = EMBEDDED["gold-leaf"].material.evaluate(*pairs)
    found = _nearest_cell(gold, *pairs)
    # the cells are half a degree to each side
    assert np.abs(found / true - 1).mean() < 0.02
    assert np.abs(read_material(gold).evaluate(*pairs) / true - 1).mean() < 0.002


def test_merl_keeps_the_top_of_a_highlight(gold):
    light, view = from_degrees(40.0, 10.0), from_degrees(40.0, 190.0)
    true = EMBEDDED["gold-leaf"].material.evaluate(light, view)
    np.testing.assert_allclose(read_material(gold).evaluate(light, view), true, rtol=0.002)


def test_merl_leaves_out_what_a_file_marks_as_missing(gold, tmp_path, pairs):
    content = bytearray(gold.read_bytes())
    planes = np.frombuffer(content, "<f8", offset=12).copy()
    planes.reshape(3, 90, 90, 180)[:, :, ::2] = -1.0
    path = tmp_path / "holes.binary"
    path.write_bytes(bytes(content[:12]) + planes.tobytes())
    whole, holes = read_material(gold).evaluate(*pairs), read_material(path).evaluate(*pairs)
    # beside a hole its neighbour speaks alone, a degree away
    assert np.abs(holes / whole - 1).max() < 0.2


def test_merl_refuses_a_grain(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(_main.cli, ["export", "satin", "--to", "merl"])
    assert "satin changes by" in str(result.exception)
    assert "--isotropic" in str(result.exception)
    assert not list(tmp_path.iterdir())


def test_utia_has_each_node_in_its_place(tilted):
    values = np.frombuffer(tilted.read_bytes(), "<f8").reshape(3, 6, 48, 6, 48)
    at = values[:, 2, 5, 4, 31]
    light, view = from_degrees(30.0, 37.5), from_degrees(60.0, 232.5)
    np.testing.assert_allclose(at, _TILTED.evaluate(light, view), rtol=1e-12)
    np.testing.assert_allclose(read_material(tilted).evaluate(light, view), at, rtol=1e-9)


def test_utia_keeps_grain_and_both_ways_of_light(tilted, pairs):
    light, view = pairs
    back = read_material(tilted)
    there = np.abs(back.evaluate(light, view) / _TILTED.evaluate(light, view) - 1)
    assert there.mean() < 0.01
    # the broken copies that a test must see: turned, and exchanged
    turned = light * [-1, 1, 1], view * [-1, 1, 1]
    assert np.abs(back.evaluate(*turned) / _TILTED.evaluate(light, view) - 1).mean() > 0.05


def test_an_imported_file_is_carried_on_its_own_grid(gold, tmp_path, monkeypatch, pairs):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(_main.cli, ["import", str(gold)])
    assert result.exit_code == 0, result.output
    assert "gonio capture --sim --material gold.npz" in result.output
    own = read_material(gold).evaluate(*pairs)
    for name in (str(gold), "gold.npz"):
        np.testing.assert_allclose(load_material(name).evaluate(*pairs), own)


BROKEN = {
    "short.binary": (b"\x5a\0\0\0" * 3 + b"\0" * 80, "length"),
    "huge.binary": (struct.pack("<3i", 2**31 - 1, 2**31 - 1, 2**31 - 1) + b"\0" * 24, "length"),
    "negative.binary": (struct.pack("<3i", -1, -1, 1) + b"\0" * 24, "length"),
    "nan.binary": (struct.pack("<3i3d", 1, 1, 1, np.nan, 1, 1), "1 values like nan"),
    "short.bin": (b"\0" * 24, "24 bytes long"),
    "empty.bin": (b"", "is empty"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_one_line(name, tmp_path):
    content, says = BROKEN[name]
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(BadFileError, match=says):
        read_material(path)


def test_a_foreign_file_is_opened_as_any_other(tilted):
    opened = open_material(str(tilted))
    assert opened.name == "tilted"
    assert opened.table.white > 0
    nodes = from_degrees(45.0, 0.0), from_degrees(15.0, 60.0)
    np.testing.assert_allclose(opened.material.evaluate(*nodes), _TILTED.evaluate(*nodes))
