"""`gonio capture --sim --imperfections` as a user runs it."""

import json

import numpy as np
import pytest
import rawpy


def linear(path):
    with rawpy.imread(str(path)) as raw:
        return raw.raw_image.astype(float)


@pytest.fixture
def planned(gonio):
    assert gonio("plan", "--density", "2", "--criterion", "farthest", "--no-page").returncode == 0


@pytest.mark.usefixtures("planned")
def test_an_imperfect_twin_takes_a_session_of_its_own(gonio, tmp_path):
    (tmp_path / "loose.toml").write_text("arm_sag_urad = 2000.0\narm_backlash_deg = 0.01\n")
    for name, options in {"ideal": (), "named": ("none",), "loose": ("loose.toml",)}.items():
        extra = ("--imperfections", *options) if options else ()
        ran = gonio("capture", "--sim", "-o", name, *extra)
        assert (ran.returncode, ran.stderr) == (0, "")
        assert ("its arms bend ([uncertainty] angle_deg)" in ran.stdout) == (name == "loose")
        assert "change color" not in ran.stdout
    frames = [
        sorted((tmp_path / name / "raw").rglob("*.dng")) for name in ("ideal", "named", "loose")
    ]
    assert len({len(each) for each in frames}) == 1
    assert all(a.read_bytes() == b.read_bytes() for a, b in zip(*frames[:2], strict=True))
    apart = [np.abs(linear(a) - linear(b)).max() for a, b in zip(frames[0], frames[2], strict=True)]
    assert max(apart) > 100
    settings = json.loads((tmp_path / "loose" / "sim" / "twin.json").read_text())
    assert settings["imperfections"] == {"arm_sag_urad": 2000.0, "arm_backlash_deg": 0.01}
    assert "imperfections" not in json.loads((tmp_path / "ideal" / "sim" / "twin.json").read_text())
    assert gonio("capture", "--sim", "--resume", "-o", "loose").returncode == 0
    ran = gonio("capture", "--sim", "--resume", "-o", "loose", "--imperfections", "mild")
    assert ran.returncode == 4
    assert "was begun with other imperfections" in ran.stderr


BAD = {
    "name": (("--sim", "--imperfections", "awful"), "use none, mild, all"),
    "file": (("--sim", "--imperfections", "none.toml"), "none.toml: no such file"),
    "no twin": (("--rig", "rig.toml", "--imperfections", "mild"), "is an option of --sim"),
}


@pytest.mark.parametrize(("arguments", "message"), BAD.values(), ids=BAD)
def test_bad_input_is_one_line(gonio, tmp_path, arguments, message):
    ran = gonio("capture", *arguments)
    assert ran.returncode == 2
    assert message in ran.stderr
    assert not (tmp_path / "session").exists()
