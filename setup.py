"""Build of the compiled parts: trainer and evaluation by vector width; the route; pixels."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from subprocess import CalledProcessError

from pybind11.setup_helpers import Pybind11Extension
from setuptools import setup
from setuptools.command.build_ext import build_ext

KERNEL = Path("nnbrdf/kernel")
ROUTE_KERNEL = Path("planner/kernel")
PIXEL_KERNEL = Path("gonio/kernel")
IS_X86 = platform.machine().lower() in ("x86_64", "amd64")
PASSES = {"nnbrdf._fused": "passes.cpp", "nnbrdf._evaluate": "evaluate.cpp"}
COSTS = {
    "nnbrdf._fused": "torch trains, some 40 times slower",
    "nnbrdf._evaluate": "NumPy evaluates, some 20 times slower",
    "planner._route": "routes are about 1 per cent longer",
    "gonio._pixels": "NumPy merges and rectifies pictures, some 20 times slower",
}
# square roots that would set errno are called one by one
FLAGS = ["-std=c++17", "-O3", "-fvisibility=hidden", "-fno-math-errno"]
WIDTHS = {"base": []}
if IS_X86:
    WIDTHS |= {
        "avx2": ["-mavx2", "-mfma"],
        "avx512": ["-mavx512f", "-mavx512dq", "-mavx512bw", "-mavx512vl", "-mavx2", "-mfma"],
    }


class BuildWidths(build_ext):
    """Compiles a module's passes for every width; which runs is chosen where the program runs."""

    def run(self) -> None:
        """Build what can be built, and say in one line what was not, why, and what that costs."""
        self.failed = {}
        super().run()
        if self.failed:
            costs = ", ".join(cost for name, cost in COSTS.items() if name in self.failed)
            reason = next(iter(self.failed.values()))
            self.warn(
                f"gonio was installed without its compiled kernels ({reason}), so {costs}; "
                "install a C++ compiler and gonio again (make -B setup)"
            )

    def build_extension(self, ext: Pybind11Extension) -> None:
        """Compile, and go on without where that fails: torch and NumPy then do what it does."""
        try:
            if source := PASSES.get(ext.name):
                ext.extra_objects = [
                    name for width in WIDTHS for name in self._passes(source, width)
                ]
            super().build_extension(ext)
        except Exception as error:
            self.failed[ext.name] = " ".join(_reason(error).split())
            raise

    def _passes(self, source: str, width: str) -> list[str]:
        return self.compiler.compile(
            [str(KERNEL / source)],
            output_dir=str(Path(self.build_temp) / width),
            macros=[("GONIO_ISA", width)],
            extra_postargs=[*FLAGS, *WIDTHS[width]],
            depends=[str(path) for path in KERNEL.glob("*.hpp")],
        )


def _reason(error: Exception) -> str:
    cause = error.__cause__ or error.__context__ or error
    if isinstance(cause, CalledProcessError):
        # the rest of the command is a page of flags
        return f"{cause.cmd[0]} ended with {cause.returncode}"
    return str(error)


def extension(name: str, sources: list[Path], flags: tuple[str, ...] = ()) -> Pybind11Extension:
    """Return one module; an installation goes on without those that do not compile."""
    return Pybind11Extension(
        name,
        [str(source) for source in sources],
        depends=[str(path) for path in sources[0].parent.iterdir()],
        define_macros=[("GONIO_X86", "1")] if IS_X86 else [],
        extra_compile_args=["-O3", *flags],
        cxx_std=17,
        optional=True,
    )


setup(
    ext_modules=[
        extension("nnbrdf._fused", [KERNEL / "module.cpp"]),
        extension("nnbrdf._evaluate", [KERNEL / "evaluate_module.cpp"]),
        extension("planner._route", sorted(ROUTE_KERNEL.glob("*.cpp"))),
        # a comparison that could trap would keep whole loops from being vectors
        extension(
            "gonio._pixels",
            sorted(PIXEL_KERNEL.glob("*.cpp")),
            ("-fno-math-errno", "-fno-trapping-math"),
        ),
    ],
    cmdclass={"build_ext": BuildWidths},
    options={"build_ext": {"parallel": os.cpu_count()}},
)
