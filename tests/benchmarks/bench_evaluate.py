"""How long a million pairs take on one core: the network in NumPy and in the kernel, and GGX.

The GGX lobe is compiled here, by the compiler that CXX names, for the vectors of this machine.
Set OMP_NUM_THREADS=1: NumPy would else take all cores.
"""

import ctypes
import os
import subprocess
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest

from nnbrdf.activations import ACTIVATIONS
from nnbrdf.analytic import AnisotropicGGX, Lambert, Sum
from nnbrdf.evaluate import evaluate
from nnbrdf.halfway import HALFWAY, HALFWAY_INPUTS
from nnbrdf.network import glorot_uniform, weight_count

_evaluate = pytest.importorskip("nnbrdf._evaluate", reason="the kernel was not compiled")
HERE = Path(__file__).resolve().parent
KERNEL = HERE.parents[1] / "nnbrdf" / "kernel"
PAIRS, RUNS = 1_000_000, 25
ALBEDO, F0, ALPHA = (0.2, 0.1, 0.05), (0.04, 0.05, 0.06), (0.1, 0.3)
SIZES = [
    ("anisotropic", (3, 5, 4)),
    ("anisotropic", (15, 29, 20)),
    ("isotropic-exchange", (15, 30, 20)),
    ("anisotropic", (32, 32, 32)),
    ("anisotropic", (64, 64, 64)),
]
DTYPES = (np.float64, np.float32)


def some_pairs(dtype):
    rng = np.random.default_rng(0)
    cos, phi = rng.random((2, PAIRS)), rng.uniform(0, 2 * np.pi, (2, PAIRS))
    sin = np.sqrt(1 - cos**2)
    light, view = np.stack([sin * np.cos(phi), sin * np.sin(phi), cos], axis=-1).astype(dtype)
    return light, view


def a_network(encoding, hidden):
    sizes = (HALFWAY_INPUTS[encoding], *hidden, 3)
    return glorot_uniform(sizes, [np.random.default_rng(0)], activation="gelu")


def best_ms(function, runs=RUNS):
    """Per million pairs, the best of some: what the machine can do when nobody else wants it."""
    milliseconds = []
    for _ in range(runs):
        start = perf_counter()
        function()
        milliseconds.append(1e3 * (perf_counter() - start))
    return min(milliseconds) * 1e6 / PAIRS


def kernel_ms(encoding, hidden, dtype):
    """Into memory that is there already, as a renderer would."""
    light, view = some_pairs(dtype)
    values = np.empty_like(light)
    run = _evaluate.evaluate64 if dtype == np.float64 else _evaluate.evaluate32
    layers = [layer[0] for layer in a_network(encoding, hidden).layers]
    numbers = list(ACTIVATIONS).index("gelu"), list(HALFWAY).index(encoding)
    return best_ms(lambda: run(layers, *numbers, 1.0, 0.01, (1, 1, 1), light, view, values))


def numpy_ms(encoding, hidden):
    """In parts that stay in cache, with its inputs and the exponential, in double precision."""
    network, (light, view) = a_network(encoding, hidden), some_pairs(np.float64)
    values = np.empty_like(light)

    def run():
        for start in range(0, PAIRS, 4096):
            part = slice(start, start + 4096)
            logs = network.forward(HALFWAY[encoding](light[part], view[part]))[0]
            values[part] = (np.exp(logs) - 0.01).clip(0)

    return best_ms(run, 2)


@pytest.fixture(scope="module")
def ggx(tmp_path_factory):
    """Evaluate the compiled lobe: ggx(light, view, values)."""
    library = tmp_path_factory.mktemp("ggx") / "ggx.so"
    flags = ["-std=c++17", "-O3", "-march=native", "-fno-math-errno", "-shared", "-fPIC"]
    command = [os.environ.get("CXX", "c++"), *flags, f"-I{KERNEL}", HERE / "ggx.cpp", "-o", library]
    subprocess.run(command, check=True)
    compiled = ctypes.CDLL(str(library))
    material = (ctypes.c_float * 8)(*ALBEDO, *F0, *ALPHA)

    def run(light, view, values):
        function = compiled.evaluate64 if light.dtype == np.float64 else compiled.evaluate32
        addresses = [ctypes.c_void_p(each.ctypes.data) for each in (light, view, values)]
        count = ctypes.c_int64(len(light))
        function(material, addresses[0], addresses[1], count, addresses[2])

    return run


@pytest.fixture(scope="module")
def ggx_ms(ggx):
    """Of double and of single precision."""
    taken = []
    for dtype in DTYPES:
        light, view = some_pairs(dtype)
        values = np.empty_like(light)
        taken.append(best_ms(lambda: ggx(light, view, values)))  # noqa: B023
    return taken


def test_the_compiled_lobe_is_that_of_the_analytic_models(ggx):
    light, view = (each[:5000].copy() for each in some_pairs(np.float64))
    values = np.empty_like(light)
    ggx(light, view, values)
    expected = Sum((Lambert(ALBEDO), AnisotropicGGX(F0, *ALPHA))).evaluate(light, view)
    assert np.allclose(values, expected, rtol=1e-4)


def test_kernel_and_analytic_model(ggx_ms):
    print(  # noqa: T201
        "\nms per million pairs, float64 / float32 directions and values"
        f"\n{'compiled anisotropic GGX':36}{ggx_ms[0]:8.1f} /{ggx_ms[1]:6.1f}"
    )
    for encoding, hidden in SIZES:
        weights = weight_count((HALFWAY_INPUTS[encoding], *hidden, 3))
        taken = [kernel_ms(encoding, hidden, dtype) for dtype in DTYPES]
        ratios = np.divide(taken, ggx_ms)
        print(  # noqa: T201
            f"{f'{weights} weights, {encoding}':36}{taken[0]:8.1f} /{taken[1]:6.1f}"
            f"; to GGX {ratios[0]:5.1f} /{ratios[1]:6.1f}"
        )
        assert min(ratios) > 1


def test_kernel_and_numpy():
    encoding, hidden = SIZES[1]
    network, (light, view) = a_network(encoding, hidden), some_pairs(np.float64)
    quick = best_ms(lambda: evaluate(network, encoding, light, view))
    slow = numpy_ms(encoding, hidden)
    print(  # noqa: T201
        f"\n{weight_count((8, *hidden, 3))} weights: NumPy {slow:.0f} ms, "
        f"nnbrdf.evaluate (allocates its values) {quick:.1f} ms; ratio {slow / quick:.0f}"
    )
    assert slow > 5 * quick
