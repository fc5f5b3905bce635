import pytest

from gonio.rig import default_rig_text

RIG = default_rig_text().replace("= 160", "= 80").replace("[79.5, 79.5]", "[39.5, 39.5]")
"""The built-in rig with a sensor that the white reference fills, to be quick."""

WORSE = """
camera_prnu = 0.02
camera_dsnu_e = 5.0
camera_dark_e_per_s = 5.0
camera_hot_share = 0.01
camera_hot_times = 500.0
camera_sensor_rise_c = 12.0
camera_full_well = 0.08
camera_vignetting = 0.4
"""
"""A camera whose every fault a calibration can take out."""


@pytest.fixture(scope="module")
def bench(all_forks, tmp_path_factory):
    """A folder with rig.toml, worse.toml, plan.json of four shots, and calibration/."""
    folder = tmp_path_factory.mktemp("bench")
    (folder / "rig.toml").write_text(RIG)
    (folder / "worse.toml").write_text(WORSE)
    for words in (
        "calibrate --sim --rig rig.toml --imperfections worse.toml",
        "plan --rig rig.toml --shots 4 --criterion farthest --max-theta 40 --no-page",
    ):
        done = all_forks.run(folder, *words.split())
        assert done.returncode == 0, done.stderr
        (folder / f"{words.split()[0]}.txt").write_text(done.stdout)
    return folder
