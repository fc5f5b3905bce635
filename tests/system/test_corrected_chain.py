"""Every imperfection on: calibration, capture, reduction and reconstruction in a row."""

import numpy as np
import pytest

from gonio.checks import Checks
from gonio.rig import default_rig_text
from gonio.samples import Flag, Samples
from sim.materials import load_material

# a sensor that sees the room beside the board at 75 deg, and lamps that are of one color
RIG = (
    default_rig_text()
    .replace("[0.002, 0.02, 0.2, 2.0]", "[0.07, 0.7]")
    .replace("[lamps]\n", "[lamps]\nwarm_up_s = 100.0\n")
) + "\n[uncertainty]\nangle_deg = 0.03\n"
STEPS = (
    "calibrate --sim --rig rig.toml --imperfections all",
    "plan --rig rig.toml --shots 8 --criterion farthest --max-theta 60 --no-page",
    "capture --sim --rig rig.toml --imperfections all --material matte-paint "
    "--calibration calibration",
    "reduce session",
    "reconstruct session --estimator paper --epochs 2",
)


pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def chain(all_forks, tmp_path_factory):
    """A folder in which every command has been run."""
    folder = tmp_path_factory.mktemp("chain")
    (folder / "rig.toml").write_text(RIG)
    for words in STEPS:
        done = all_forks.run(folder, *words.split())
        assert done.returncode == 0, done.stderr
    return folder


def test_samples_are_near_the_truth(chain):
    samples = Samples.load(chain / "session/samples.nc")
    truth = load_material("matte-paint").evaluate(samples.light, samples.view)
    assert samples.value.shape == (8, 3)
    assert not (samples.flag & Flag.SUSPECT).any()
    # without the calibration, 5 %
    assert np.median(np.abs(samples.value / truth - 1.0)) < 0.01
    assert (samples.components["calibration"] > 0).all()


def test_the_report_shows_the_checks(chain):
    page = (chain / "session/report.html").read_text()
    checks = Checks.load(chain / "session/checks.json").checks
    assert len(checks) > 10
    for check in checks:
        assert check.name in page
