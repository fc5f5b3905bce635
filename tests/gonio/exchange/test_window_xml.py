"""LBNL's XML, written and read by the command line, and read by Radiance."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.cli.export import command as export_command
from gonio.cli.import_ import command as import_command
from gonio.directions import from_spherical, to_degrees
from gonio.errors import BadFileError
from gonio.exchange import (
    Source,
    format_named,
    klems_writing,
    read_material,
    tensor_tree,
    tree,
)
from gonio.exchange.klems import BASES, patch_of, points_in
from gonio.exchange.klems_writing import averages, few_points
from gonio.exchange.window_xml import xyz_of
from planner.candidates import candidates_named
from sim.materials import EMBEDDED


def run(command, *arguments):
    arguments = [str(each) for each in arguments]
    return CliRunner().invoke(command, arguments, catch_exceptions=False)


@pytest.fixture(scope="module")
def klems(tmp_path_factory):
    """A file of brushed metal, its means over few points."""
    path = tmp_path_factory.mktemp("klems") / "metal.xml"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(klems_writing, "_FINER", ((0.2, 3),))
        ran = run(export_command, "brushed-metal", "--to", "klems", "-o", path)
    assert "eps8" in ran.output
    return path


def some_pairs(count=300):
    rng = np.random.default_rng(3)
    theta, phi = np.arcsin(np.sqrt(rng.random((2, count)))), rng.random((2, count)) * 2 * np.pi
    light, view = from_spherical(np.minimum(theta, 1.55), phi)
    return light, view


READS = """
import json, sys
from pyradiance import bsdf
data = bsdf.load_file(sys.argv[1])
told = [[*map(float, bsdf.query(data, *each))] for each in json.load(sys.stdin)]
json.dump(told, sys.stdout)
"""


def by_radiance(path, light, view):
    """CIE XYZ of pairs as Radiance's own reader returns them."""
    pytest.importorskip("pyradiance")
    angles = np.stack([*to_degrees(light), *to_degrees(view)], axis=1)
    # a fault in that library ends the process that it is in
    told = subprocess.run(
        [sys.executable, "-c", READS, str(path)],
        input=json.dumps(angles.tolist()), capture_output=True, text=True, check=True,
    )  # fmt: skip
    return np.array(json.loads(told.stdout))


def test_radiance_reads_a_matrix_as_gonio_does(klems):
    light, view = some_pairs()
    xyz = xyz_of(read_material(klems).evaluate(light, view))
    told = by_radiance(klems, light, view)
    assert np.allclose(told[:, 1], xyz[:, 1], rtol=1e-3, atol=1e-4 * xyz.max())
    # chroma is kept in two bytes
    assert np.allclose(told, xyz, rtol=0.05, atol=0.02 * xyz.max())


class OfTheLight:
    """What depends on where light comes from, and is so of no physical material."""

    def evaluate(self, light, view):
        shape = np.broadcast_shapes(light.shape, view.shape)
        value = 0.1 + 0.05 * light[..., :1] + 0.02 * light[..., 1:2]
        return np.broadcast_to(value, shape)


class Turning:
    """Isotropic, but neither mirrored nor the same with light and view exchanged."""

    def evaluate(self, light, view):
        aside = light[..., 0] * view[..., 1] - light[..., 1] * view[..., 0]
        along = light[..., 0] * view[..., 0] + light[..., 1] * view[..., 1]
        value = 0.2 + 0.1 * aside + 0.03 * along + 0.05 * light[..., 2]
        return value[..., None] * np.array([1.0, 0.8, 0.5])


def test_radiance_reads_an_isotropic_tree_as_gonio_does(tmp_path, monkeypatch):
    monkeypatch.setattr(tensor_tree, "_ISOTROPIC", 16)
    path = tmp_path / "turning.xml"
    format_named("tensortree").write(Source(Turning(), "turning"), path, None)
    assert "TensorTree3" in path.read_text()
    light, view = some_pairs()
    told = by_radiance(path, light, view)
    assert np.allclose(xyz_of(read_material(path).evaluate(light, view)), told, rtol=2e-3)
    assert np.abs(told - xyz_of(Turning().evaluate(light, view))).max() < 0.03


@pytest.mark.parametrize("name", ["klems", "tensortree"])
def test_incident_and_outgoing_are_not_exchanged(name, tmp_path, monkeypatch):
    monkeypatch.setattr(tensor_tree, "_ANISOTROPIC", 16)
    path = tmp_path / "lit.xml"
    format_named(name).write(Source(OfTheLight(), "lit"), path, None)
    light, view = some_pairs()
    told = by_radiance(path, light, view)[:, 1]
    assert np.abs(told - OfTheLight().evaluate(light, view)[:, 0]).max() < 0.02
    assert np.allclose(read_material(path).evaluate(light, view)[:, 1], told, rtol=1e-3)


def test_patches_are_those_that_a_plan_measures():
    candidates = candidates_named("klems")
    assert (patch_of("LBNL/Klems Full", candidates.directions) == np.arange(145)).all()


@pytest.mark.parametrize("basis", BASES)
def test_points_of_a_patch_lie_in_it(basis):
    numbers = np.arange(sum(BASES[basis][1]))
    patch = patch_of(basis, points_in(basis, numbers, few_points()))
    assert (patch == numbers[:, None]).all()


def test_means_over_patches_are_those_of_highlights_too():
    basis, material = "LBNL/Klems Quarter", EMBEDDED["glossy-plastic"].material
    told = averages(material, basis)
    rng = np.random.default_rng(2)
    # a patch of the light is named by where that goes to, which is where a mirror sends it
    for patch in (0, 3, 24):
        light, view = points_in(basis, np.array([patch]), rng.random((100_000, 2)))[0].reshape(
            2, -1, 3
        )
        true = material.evaluate(light * [-1.0, -1.0, 1.0], view).mean(axis=0)
        np.testing.assert_allclose(told[patch, patch], true, rtol=0.03)


def edited(path, tmp_path, old, new):
    made = tmp_path / "edited.xml"
    made.write_text(re.sub(old, new, path.read_text(), flags=re.DOTALL))
    return made


BAD = [
    (r"\?>", '?><!DOCTYPE a [<!ENTITY b "c">]>', "has a document type"),
    ("<Layer>.*</Layer>", "", "has no element Layer"),
    ("Visible", "Solar", "has no visible reflection"),
    ("Reflection", "Transmission", "has no visible reflection"),
    ("Columns", "Diagonal", "holds 'Diagonal', no matrix"),
    ("(RowAngleBasis>LBNL/Klems) Full", r"\1 Tiny", "is of the basis 'lbnl/klems tiny'"),
    ("<ScatteringData>\n[^,]*,", "<ScatteringData>", "has 21024 values for visible"),
    ("<ScatteringData>\n[^,]*,", "<ScatteringData> nan,", "not finite"),
    ("<ScatteringData>\n[^,]*,", "<ScatteringData> one,", "holds what is no number"),
    ("</Layer>.*", "", "is no XML"),
    ("<Layer>", "<Layer>" + 40 * "<a>", "more elements than such files have"),
    ("UTF-8", "EBCDIC-9", "is no XML"),
]


@pytest.mark.parametrize(("old", "new", "problem"), BAD)
def test_bad_files_are_refused_in_a_line(klems, tmp_path, old, new, problem):
    path = edited(klems, tmp_path, old, new)
    with pytest.raises(BadFileError, match=problem):
        format_named("klems").read(path)


def test_a_matrix_is_imported_by_its_content(klems, tmp_path):
    ran = run(import_command, klems, "-o", tmp_path / "metal.npz")
    assert "Klems" in ran.output
    light, view = some_pairs(20)
    again = read_material(tmp_path / "metal.npz").evaluate(light, view)
    assert np.array_equal(again, read_material(klems).evaluate(light, view))


def test_a_matrix_may_be_called_by_the_name_of_a_tree(klems, tmp_path):
    path = edited(klems, tmp_path, "<Name>brushed-metal", "<Name>TensorTree4")
    ran = run(import_command, path, "-o", tmp_path / "metal.npz")
    assert "Klems" in ran.output


def test_the_other_side_runs_the_other_way(klems, tmp_path):
    path = edited(klems, tmp_path, "Reflection Back", "Reflection Front")
    light, view = some_pairs(20)
    mirror = np.array([-1.0, 1.0, 1.0])
    told = read_material(path).evaluate(light * mirror, view * mirror)
    assert np.array_equal(told, read_material(klems).evaluate(light, view))


@pytest.mark.parametrize("name", ["brushed-metal"])
def test_radiance_reads_trees_as_gonio_does(name, tmp_path, monkeypatch):
    monkeypatch.setattr(tensor_tree, "_ANISOTROPIC", 8)
    monkeypatch.setattr(tensor_tree, "_ISOTROPIC", 16)
    path = tmp_path / "tree.xml"
    assert run(export_command, name, "--to", "tensortree", "-o", path).exit_code == 0
    light, view = some_pairs()
    xyz = xyz_of(read_material(path).evaluate(light, view))
    assert np.allclose(by_radiance(path, light, view), xyz, rtol=2e-3, atol=1e-3)


BRACES = [
    ("", "does not begin with a brace"),
    ("1", "does not begin with a brace"),
    ("{1} 2", "goes on after its last brace"),
    ("{1 2}", "has a leaf of 2 values"),
    ("{{1}{2}}", "has a node of 2 branches"),
    ("{{1} 2}", "mixes values with branches"),
    ("{1 {2}}", "has a node of 1 branches"),
    ("{nan}", "holds values that are not finite"),
    ("{x}", "could not convert"),
    ("{1", "ends within a brace"),
    ("{" * 99, "is deeper than 12"),
    ("{" * 6 + "{1}" * 9, "mixes values with branches, or has too many"),
    ("{" + 8 * ("{" + 8 * "{1}" + "}") + "}", "has more than 64 nodes"),
]


@pytest.mark.parametrize(("text", "problem"), BRACES)
def test_braces_that_are_no_tree_are_refused(text, problem, monkeypatch):
    monkeypatch.setattr(tree, "_MOST_NODES", 64)
    with pytest.raises(ValueError, match=problem):
        tree.parse(text, 3)
