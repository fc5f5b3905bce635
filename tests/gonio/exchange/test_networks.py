"""Networks in other languages against the model itself, by the tools that read them."""

import ast
import ctypes
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from gonio.errors import BadInputError
from gonio.exchange.networks import c_header, glsl, mitsuba_plugin, onnx_graph
from gonio.exchange.networks.activations import ACTIVATIONS as FORMULAS
from gonio.exchange.networks.activations import activation_of
from gonio.exchange.networks.expression import CONSTANT, INPUT, in_order
from gonio.exchange.networks.inputs import inputs_of
from gonio.exchange.networks.portable import portable_of
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.analytic import Lambert
from nnbrdf.encoding import ENCODINGS as PLAIN
from nnbrdf.halfway import HALFWAY
from tests.gonio.exchange.networks import ENCODINGS, exactly, model, plain, some_pairs, taught

LIGHT, VIEW = some_pairs()
NUMPY = {
    "add": np.add, "subtract": np.subtract, "multiply": np.multiply, "divide": np.divide,
    "sqrt": np.sqrt, "exp": np.exp, "log": np.log, "absolute": np.abs, "sin": np.sin,
    "cos": np.cos, "tanh": np.tanh, "atan2": np.arctan2, "maximum": np.maximum,
    "minimum": np.minimum, "where_less": lambda a, b, c, d: np.where(a < b, c, d),
}  # fmt: skip
# single precision against double; the steepest activations of the worst pair are in it
CLOSE = 2e-5
each_encoding = pytest.mark.parametrize("encoding", ENCODINGS)
MODELS = {
    "taught": taught(),
    "gray": taught("anisotropic-exchange", gray=True),
    "plain": plain(),
    "angles": plain("rusinkiewicz", "tanh"),
}
each_model = pytest.mark.parametrize("name", MODELS)


def compute(results, inputs):
    """What formulas say, in NumPy."""
    from scipy.special import erf

    values = {}
    for each in in_order(results):
        if each.operation == CONSTANT:
            values[id(each)] = each.value
        elif each.operation == INPUT:
            values[id(each)] = inputs[each.name]
        else:
            function = (NUMPY | {"erf": erf})[each.operation]
            values[id(each)] = function(*(values[id(operand)] for operand in each.operands))
    return [values[id(each)] for each in results]


@each_encoding
def test_formulas_of_inputs_are_the_inputs(encoding):
    light, view = LIGHT.astype(float), VIEW.astype(float)
    # and where both are the same, mirrored, and along the normal
    light[:3], view[:3] = (
        [[0, 0, 1], [0.6, 0, 0.8], [0.6, 0, 0.8]],
        [[0, 0, 1], [-0.6, 0, 0.8], [0.6, 0, 0.8]],
    )
    inputs = {f"{name}{axis}": each for name, ways in (("l", light), ("v", view))
              for axis, each in zip("xyz", ways.T, strict=True)}  # fmt: skip
    told = np.stack(np.broadcast_arrays(*compute(inputs_of(encoding), inputs)), axis=1)
    assert np.allclose(told, (PLAIN | HALFWAY)[encoding](light, view), atol=1e-7)


@pytest.mark.parametrize("activation", FORMULAS)
def test_formulas_of_activations_are_the_activations(activation):
    x = np.linspace(-6, 6, 501)
    (told,) = compute([activation_of(activation)], {"x": x})
    assert np.allclose(told, ACTIVATIONS[activation](x), atol=1e-12)


def test_all_that_there_is_has_formulas():
    assert set(ACTIVATIONS) - set(FORMULAS) == {"softmax"}
    assert set(ENCODINGS) == set(PLAIN | HALFWAY)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """Compile C text that includes a header and evaluate it: compiled(header, light, view)."""
    if shutil.which("gcc") is None:
        pytest.skip("needs gcc")

    def run(header, light, view, language="c"):
        folder = tmp_path_factory.mktemp("compiled")
        (folder / "brdf.h").write_text(header)
        (function,) = re.findall(r"void (gonio_\w+)\(const float", header)
        linkage = 'extern "C" ' if language == "c++" else ""
        (folder / "all.c").write_text(
            '#include "brdf.h"\n' + linkage + "void all(const float *l, const float *v, int n, "
            "float *rgb) { for (int i = 0; i < n; ++i) "
            f"{function}(l + 3 * i, v + 3 * i, rgb + 3 * i); }}\n"
        )
        standard = {"c": "-std=c99", "c++": "-std=c++11"}[language]
        command = ["gcc", "-x", language, standard, "-O1", "-Wall", "-Wextra", "-Werror", "-shared"]
        command += ["-fPIC", "all.c", "-o", "all.so", "-lm"]
        subprocess.run(command, cwd=folder, check=True)
        rgb, count = np.empty_like(light), ctypes.c_int(len(light))
        light, view = np.ascontiguousarray(light), np.ascontiguousarray(view)
        address = [ctypes.c_void_p(each.ctypes.data) for each in (light, view, rgb)]
        ctypes.CDLL(str(folder / "all.so")).all(*address[:2], count, address[2])
        return rgb

    return run


def assert_close(told, name, light=LIGHT, view=VIEW):
    expected = exactly(MODELS[name], light.astype(float), view.astype(float))
    assert np.abs(told - expected).max() < CLOSE * expected.max()


@each_model
def test_c_says_what_the_model_says(name, compiled):
    assert_close(compiled(c_header.text_of(portable_of(MODELS[name], name)), LIGHT, VIEW), name)


def test_the_header_is_cpp_as_well_and_names_do_no_harm(compiled):
    network = replace(
        portable_of(MODELS["taught"], '*/ #error """\n//\\'), color_space="*/\n#error"
    )
    ast.parse(mitsuba_plugin.text_of(network, 'a"""b', anisotropic=False))
    text = c_header.text_of(network)
    assert_close(compiled(text, LIGHT, VIEW, "c++"), "taught")


def test_two_headers_are_two_materials_and_one_name_is_one(tmp_path):
    if shutil.which("gcc") is None:
        pytest.skip("needs gcc")

    def compiles(*files):
        lines = [f'#include "{name}"\n' for name in files]
        command = ["gcc", "-x", "c", "-std=c99", "-fsyntax-only", "-"]
        ran = subprocess.run(
            command, cwd=tmp_path, input="".join(lines), text=True, capture_output=True, check=False
        )
        return ran.returncode == 0

    for file, kind, name in (
        ("a", "taught", "red"),
        ("b", "plain", "2 blue"),
        ("c", "gray", "red"),
    ):
        text = c_header.text_of(portable_of(MODELS[kind], name))
        (tmp_path / f"{file}.h").write_text(text)
    assert compiles("a.h", "b.h", "a.h")
    assert not compiles("a.h", "c.h")


def test_below_the_horizon_there_is_nothing(compiled):
    text = c_header.text_of(portable_of(MODELS["plain"], "plain"))
    down = LIGHT * np.float32([1, 1, -1])
    assert (compiled(text, down, VIEW) == 0).all()
    assert (compiled(text, LIGHT, -VIEW) == 0).all()


_STAGES = {
    "330": "#version 330 core\nin vec3 l, v; out vec4 c;\n",
    "300 es": "#version 300 es\nprecision highp float;\nin vec3 l, v; out vec4 c;\n",
}


@pytest.mark.parametrize("version", _STAGES)
@each_model
def test_glsl_compiles(name, version, tmp_path):
    if shutil.which("glslangValidator") is None:
        pytest.skip("needs glslangValidator")
    text = glsl.text_of(portable_of(MODELS[name], name))
    shader = tmp_path / "brdf.frag"
    shader.write_text(
        f"{_STAGES[version]}{text}void main() {{ c = vec4(gonio_{name}(l, v), 1.0); }}"
    )
    ran = subprocess.run(["glslangValidator", shader], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout


_AS_CPP = """
#include <cmath>
#include <algorithm>
using namespace std;
struct vec3 { float x, y, z; vec3(float a) : x(a), y(a), z(a) {}
    vec3(float a, float b, float c) : x(a), y(b), z(c) {} };
static inline float clamp(float x, float a, float b) { return min(max(x, a), b); }
static inline float sign(float x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
static inline float atan(float y, float x) { return atan2(y, x); }
"""


@each_model
def test_glsl_says_what_the_model_says(name, compiled):
    """As C++: its functions are C++ but for the way in which arrays and numbers are written."""
    text = glsl.text_of(portable_of(MODELS[name], name))
    text = re.sub(r"= float\[\d+\]\(([^)]*)\);", r"= {\1};", text)
    text = re.sub(r"\b(\d+\.\d+(e[+-]?\d+)?|\d+e[+-]?\d+)", r"\g<0>f", text)
    text = text.replace(f"vec3 gonio_{name}(", "static vec3 shade(")
    text += (
        "static void gonio_brdf(const float *l, const float *v, float *c) { vec3 r = "
        "shade(vec3(l[0], l[1], l[2]), vec3(v[0], v[1], v[2])); c[0]=r.x; c[1]=r.y; c[2]=r.z; }"
    )
    assert_close(compiled(_AS_CPP + text, LIGHT, VIEW, "c++"), name)


@each_model
def test_onnxruntime_reads_what_the_model_says(name):
    onnx = pytest.importorskip("onnx")
    runtime = pytest.importorskip("onnxruntime")
    graph = onnx_graph.model_of(portable_of(MODELS[name], name))
    onnx.checker.check_model(graph)
    session = runtime.InferenceSession(graph.SerializeToString())
    (told,) = session.run(None, {"light": LIGHT, "view": VIEW})
    assert_close(told, name)
    (below,) = session.run(None, {"light": LIGHT, "view": -VIEW})
    assert (below == 0).all()


def test_what_is_no_network_is_refused_in_one_line():
    with pytest.raises(BadInputError, match="is no network"):
        portable_of(Lambert((0.5, 0.5, 0.5)), "paper")
    with pytest.raises(BadInputError, match="softmax"):
        portable_of(model("xyz", activation="softmax"), "odd")
    broken = plain()
    broken.networks.layers[0][1, 0, 0] = np.nan
    with pytest.raises(BadInputError, match="not finite"):
        portable_of(broken, "broken")
