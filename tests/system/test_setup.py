"""Installing where nothing compiles: it works, and says what that costs."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

COMPILERS = [
    ("fails", shutil.which("false"), "false ended with 1"),
    ("missing", "/nowhere/g++", "No such file or directory: '/nowhere/g++'"),
]


@pytest.mark.parametrize(
    ("compiler", "why"), [c[1:] for c in COMPILERS], ids=[c[0] for c in COMPILERS]
)
def test_without_a_compiler_one_line_says_why_and_what_it_costs(tmp_path, compiler, why):
    pytest.importorskip("pybind11", reason="needs what setup.py builds with")
    pytest.importorskip("setuptools", reason="needs what setup.py builds with")
    shutil.copy(ROOT / "setup.py", tmp_path)
    for package in ("gonio", "nnbrdf", "planner"):
        shutil.copytree(ROOT / package / "kernel", tmp_path / package / "kernel")
    ran = subprocess.run(
        [sys.executable, "setup.py", "-q", "build_ext", "--build-lib", "built"],
        cwd=tmp_path,
        env=os.environ | {"CC": compiler, "CXX": compiler},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    said = [line for line in ran.stderr.splitlines() if "installed without" in line]
    assert len(said) == 1
    assert why in said[0]
    assert "torch trains, some 40 times slower, NumPy evaluates, some 20 times slower" in said[0]
    assert "install a C++ compiler and gonio again" in said[0]
    # what make setup looks for in pip's log
    assert "gonio was installed without" in (ROOT / "Makefile").read_text()
    assert "gonio was installed without" in said[0]
