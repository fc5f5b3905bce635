"""How long a pair takes on one core, and how far it is off: C header, onnxruntime, kernel."""

import ctypes
import os
import subprocess
from time import perf_counter

import numpy as np
import pytest

from gonio.exchange.networks import c_header, onnx_graph
from gonio.exchange.networks.portable import portable_of
from nnbrdf.evaluate import evaluate
from tests.gonio.exchange.networks import exactly, some_pairs, taught

PAIRS = 100_000
HIDDEN = (15, 29, 20)


def microseconds(function):
    """A pair, the best of five."""
    taken = []
    for _ in range(5):
        start = perf_counter()
        function()
        taken.append(1e6 * (perf_counter() - start) / PAIRS)
    return min(taken)


def worst(told, expected):
    """Of the largest value."""
    return np.abs(told - expected).max() / expected.max()


def compiled(text, folder, flags):
    folder.mkdir()
    (folder / "brdf.h").write_text(text)
    (folder / "all.c").write_text(
        '#include "brdf.h"\nvoid all(const float *l, const float *v, int n, float *c)'
        "{ for (int i = 0; i < n; ++i) gonio_bench(l + 3 * i, v + 3 * i, c + 3 * i); }\n"
    )
    command = [os.environ.get("CC", "cc"), *flags, "-shared", "-fPIC", "all.c", "-o", "all.so"]
    subprocess.run([*command, "-lm"], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "all.so")).all


@pytest.mark.parametrize("activation", ["gelu", "softsign"])
def test_exports_and_kernel(activation, tmp_path):
    runtime = pytest.importorskip("onnxruntime")
    model = taught("anisotropic", activation, HIDDEN)
    network, (light, view) = portable_of(model, "bench"), some_pairs(PAIRS)
    kernel = microseconds(lambda: evaluate(model.value, "anisotropic", light, view))
    print(f"\n{network.description}: kernel {kernel:.3f} us a pair")  # noqa: T201
    expected = exactly(model, light.astype(float), view.astype(float))
    options = runtime.SessionOptions()
    options.intra_op_num_threads = 1
    graph = onnx_graph.model_of(network).SerializeToString()
    session = runtime.InferenceSession(graph, options)
    onnx = microseconds(lambda: session.run(None, {"light": light, "view": view}))
    print(f"onnxruntime {onnx:.3f} us, {onnx / kernel:.1f} x kernel")  # noqa: T201
    (told,) = session.run(None, {"light": light, "view": view})
    print(f"onnxruntime is at most {worst(told, expected):.1e} off")  # noqa: T201
    rgb = np.empty_like(light)
    addresses = [ctypes.c_void_p(each.ctypes.data) for each in (light, view, rgb)]
    for flags in (["-O2"], ["-O3", "-march=native"], ["-O3", "-march=native", "-ffast-math"]):
        run = compiled(c_header.text_of(network), tmp_path / flags[-1].strip("-"), flags)
        taken = microseconds(lambda: run(*addresses[:2], PAIRS, addresses[2]))  # noqa: B023
        print(f"C header {' '.join(flags)} {taken:.3f} us, {taken / kernel:.1f} x kernel")  # noqa: T201
        print(f"which is at most {worst(rgb, expected):.1e} off")  # noqa: T201
        assert worst(rgb, expected) < 1e-5
