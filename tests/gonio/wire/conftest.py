"""A twin served at real ports, ten times as fast as a rig."""

import os
import signal
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
import tomli_w

from gonio.rig import default_rig_text

SPEED = 20
# drivers wait out an exposure by the host's clock, however fast the twin is
EXPOSURES = "[0.02, 0.2]"


@dataclass
class Served:
    """A served twin."""

    folder: Path
    process: subprocess.Popen

    @property
    def rig(self):
        return self.folder / "rig.toml"

    def end(self):
        """Stop it; return what it says."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.communicate(timeout=30)[0]

    def tell(self, *words):
        command = [sys.executable, "-m", "gonio", "sim", *words, "--at", str(self.folder)]
        subprocess.run(command, check=True, capture_output=True)


def serve(folder, *options):
    folder.parent.mkdir(exist_ok=True)
    rig = folder.parent / "short.toml"
    rig.write_text(default_rig_text().replace("[0.002, 0.02, 0.2, 2.0]", EXPOSURES))
    process = subprocess.Popen(
        [sys.executable, "-m", "gonio", "sim", "serve", "--rig", rig, "--folder", folder, *options],
        stdout=subprocess.PIPE, text=True, env=os.environ | {"OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    for _ in range(2):  # what it serves, and the command to type
        assert process.stdout.readline()
    return Served(folder, process)


@pytest.fixture(scope="module", params=["tcp", "rtu"])
def served(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param) / "served"
    options = ["--rtu"] if request.param == "rtu" else []
    twin = serve(folder, "--speed", str(SPEED), *options)
    yield twin
    twin.end()


@pytest.fixture
def manual_rig(served, tmp_path):
    """The served rig, where a person changes what lies in the holder."""
    data = tomllib.loads(served.rig.read_text())
    del data["holder"]["changer"], data["holder"]["changer_command"]
    rig = tmp_path / "manual.toml"
    rig.write_text(tomli_w.dumps(data))
    return rig


@pytest.fixture
def serve_twin(tmp_path):
    """Serve a twin of this test's own: serve_twin("--faults", file)."""
    started = []

    def start(*options):
        started.append(serve(tmp_path / "twin/served", "--speed", str(SPEED), *options))
        return started[-1]

    yield start
    for twin in started:
        twin.process.kill()
        twin.process.communicate()
