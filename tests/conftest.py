"""What all tests share: running the command line, and the measured materials where they are."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import settings

# a first call may import a heavy library, which says nothing about the code under test
settings.register_profile("gonio", deadline=None)
settings.load_profile("gonio")

MEASURED = Path(__file__).resolve().parents[2] / "shared" / "materials"


@pytest.fixture
def measured() -> Path:
    """Folder of measured materials; a test that asks for it is skipped where it is missing."""
    if not MEASURED.is_dir():
        pytest.skip("needs ../shared/materials")
    return MEASURED


@pytest.fixture
def gonio(tmp_path):
    """Run `gonio` as a user does, in an empty folder: gonio("plan", "--density", "4")."""

    def run(*arguments, cwd=None, timeout=240):
        return subprocess.run(
            [sys.executable, "-m", "gonio", *map(str, arguments)],
            cwd=cwd or tmp_path,
            env=os.environ | {"COLUMNS": "120", "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )

    return run
