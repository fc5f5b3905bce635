"""Build of the one compiled part: the fused trainer, once for each vector width."""

from __future__ import annotations

import platform
from pathlib import Path

from pybind11.setup_helpers import Pybind11Extension
from setuptools import setup
from setuptools.command.build_ext import build_ext

KERNEL = Path("nnbrdf/kernel")
IS_X86 = platform.machine().lower() in ("x86_64", "amd64")
WIDTHS = {"base": []}
if IS_X86:
    WIDTHS |= {
        "avx2": ["-mavx2", "-mfma"],
        "avx512": ["-mavx512f", "-mavx512dq", "-mavx512bw", "-mavx512vl", "-mavx2", "-mfma"],
    }


class BuildWidths(build_ext):
    """Compiles the passes for every width; which one runs is chosen where the program runs."""

    def build_extension(self, ext: Pybind11Extension) -> None:
        """Compile, and go on without where that fails: training then takes the path of torch."""
        try:
            ext.extra_objects = [name for width in WIDTHS for name in self._passes(width)]
            super().build_extension(ext)
        except Exception as error:
            self.warn(f"no compiled trainer ({error}); training will use torch")
            raise

    def _passes(self, width: str) -> list[str]:
        return self.compiler.compile(
            [str(KERNEL / "passes.cpp")],
            output_dir=str(Path(self.build_temp) / width),
            macros=[("GONIO_ISA", width)],
            extra_postargs=["-std=c++17", "-O3", "-fvisibility=hidden", *WIDTHS[width]],
            depends=[str(path) for path in KERNEL.glob("*.hpp")],
        )


setup(
    ext_modules=[
        Pybind11Extension(
            "nnbrdf._fused",
            [str(KERNEL / "module.cpp")],
            depends=[str(path) for path in KERNEL.glob("*.hpp")],
            define_macros=[("GONIO_X86", "1")] if IS_X86 else [],
            cxx_std=17,
            optional=True,
        )
    ],
    cmdclass={"build_ext": BuildWidths},
)
