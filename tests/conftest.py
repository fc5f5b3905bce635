"""What all tests share: running the command line, and the measured materials where they are."""

import contextlib
import os
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import settings

from gonio.journal import Journal
from tests.forks import Forks

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
def tampered():
    """Change what is append-only: tampered(journal.sqlite, sql, parameters)."""

    def change(path, sql, parameters=()):
        with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as journal:
            for (name,) in journal.execute("SELECT name FROM sqlite_master WHERE type = 'trigger'"):
                journal.execute(f"DROP TRIGGER {name}")
            journal.execute(sql, parameters)

    return change


@pytest.fixture
def rewritten(tampered):
    """Change a journal as `tampered` does, and write what is left anew as if it had been all."""

    def change(path, sql, parameters=()):
        tampered(path, sql, parameters)
        with Journal(path) as journal:
            events = list(journal.events())
        path.unlink()
        with Journal(path, writing=True) as journal:
            for event in events:
                journal._insert(event.at_s, event.utc, event.kind, event.data)

    return change


@pytest.fixture(scope="session")
def all_forks():
    """Runs `gonio` in forks of one process a worker, which has imported it: see tests.forks."""
    with contextlib.closing(Forks()) as forks:
        yield forks


@pytest.fixture
def gonio(all_forks, tmp_path):
    """Run `gonio` as a user does, in an empty folder: gonio("plan", "--density", "4").

    It is a process without the second of imports; for one from nothing see `gonio_from_nothing`.
    """

    def run(*arguments, cwd=None, timeout=240):
        return all_forks.run(cwd or tmp_path, *arguments, timeout=timeout)

    return run


@pytest.fixture
def gonio_from_nothing(tmp_path):
    """Run `gonio` in a new interpreter, where imports, hashes of strings or the exit matter."""

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
