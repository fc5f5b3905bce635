"""`gonio export --to` of networks, by the command line."""

import ast
import os
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.cli.export import command
from gonio.errors import BadInputError
from tests.gonio.exchange.networks import exactly, some_pairs, taught

FORMATS = {"c": ".h", "glsl": ".glsl", "onnx": ".onnx", "mitsuba": ".py"}


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """Folder of a saved network."""
    folder = tmp_path_factory.mktemp("models") / "leather"
    taught().save(folder)
    return folder


def export(*arguments):
    arguments = [str(each) for each in arguments]
    return CliRunner().invoke(command, arguments, catch_exceptions=False)


@pytest.mark.parametrize("name", FORMATS)
def test_a_saved_model_is_exported_and_says_what_is_lost(name, model, tmp_path):
    if name == "onnx":
        pytest.importorskip("onnx")
    path = tmp_path / f"leather{FORMATS[name]}"
    ran = export(model, "--to", name, "-o", path)
    assert ran.exit_code == 0
    assert "loses sigma" in ran.output
    assert path.stat().st_size > 1000


def test_the_plugin_is_called_after_the_model_and_is_python(model, tmp_path):
    path = tmp_path / "other.py"
    export(model, "--to", "mitsuba", "-o", path)
    text = path.read_text()
    ast.parse(text)
    assert 'mi.register_bsdf("gonio_leather", GonioBSDF)' in text
    assert "import other " in text
    assert "ANISOTROPIC = False" in text


@pytest.mark.parametrize("name", FORMATS)
def test_the_name_of_a_model_need_not_be_text(name, tmp_path):
    if name == "onnx":
        pytest.importorskip("onnx")
    folder = tmp_path / os.fsdecode(b"leather\xff")
    taught().save(folder)
    assert export(folder, "--to", name, "-o", tmp_path / "out").exit_code == 0


def test_the_plugin_can_be_imported_whatever_the_model_is_called(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    taught().save(tmp_path / "2026-11 leather-a")
    assert export("2026-11 leather-a", "--to", "mitsuba").exit_code == 0
    (made,) = tmp_path.glob("*.py")
    assert made.stem == "gonio_2026_11_leather_a"
    assert f"import {made.stem} " in made.read_text()


def test_onnx_of_a_saved_model_reads_as_the_model(model, tmp_path):
    pytest.importorskip("onnx")
    runtime = pytest.importorskip("onnxruntime")
    export(model, "--to", "onnx", "-o", tmp_path / "leather.onnx")
    session = runtime.InferenceSession(tmp_path / "leather.onnx")
    light, view = some_pairs(50)
    (told,) = session.run(None, {"light": light, "view": view})
    assert np.allclose(told, exactly(taught(), light.astype(float), view.astype(float)), rtol=1e-4)


def test_what_is_no_network_is_refused_and_leaves_nothing(tmp_path):
    with pytest.raises(BadInputError, match="is no network"):
        export("matte-paint", "--to", "c", "-o", tmp_path / "paint.h")
    assert not list(tmp_path.iterdir())


def test_as_a_user_does(model, tmp_path):
    command_line = [sys.executable, "-m", "gonio", "export", str(model), "--to", "glsl"]
    ran = subprocess.run(command_line, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ran.stdout.startswith("wrote leather.glsl")
    assert (tmp_path / "leather.glsl").is_file()
