"""`gonio geometry` as a user runs it: the twin's frames to what the twin was made with."""

import json
import math

import numpy as np
import pytest

from gonio.alignment import ALIGNED, Alignment
from gonio.directions import normalize
from gonio.errors import BadFileError
from gonio.photogrammetry.adjustment import adjust
from gonio.photogrammetry.geometry_file import Geometry
from gonio.rig import default_rig, default_rig_text
from gonio.samples import Samples
from gonio.session import Session

from .views import FINE, corners_seen

# 6 px/mm, so that a marker's module is 3 px at 60 deg
RIG = (
    default_rig_text()
    .replace("= 160", "= 800")
    .replace("[79.5, 79.5]", "[399.5, 399.5]")
    .replace("focal_px = 4000.0", "focal_px = 12100.0")
    .replace("exposures_s = [0.002, 0.02, 0.2, 2.0]", "exposures_s = [0.2]")
) + "\n[uncertainty]\nangle_deg = 0.02\n"
INJECTED = {
    "theta_offset_deg": 0.3,
    "phi_offset_deg": -0.4,
    "phi_tilt_x_deg": 0.2,
    "phi_tilt_y_deg": -0.15,
    "theta_tilt_deg": 0.1,
    "roll_deg": 0.25,
    "distance_mm": 3.0,
    "centre_x_mm": 0.5,
    "centre_y_mm": -0.4,
    "centre_z_mm": 0.3,
}


@pytest.fixture
def captured(gonio, tmp_path):
    """Capture some views of the board; return where the session is."""

    def capture(rig, views, *options):
        (tmp_path / "rig.toml").write_text(rig)
        which = ("--view-candidates", views, "--views", "all", "--lights", "1", "--no-page")
        for arguments in (
            ("plan", "--rig", "rig.toml", *which),
            ("capture", "--sim", "--rig", "rig.toml", "--material", "charuco", *options),
        ):
            ran = gonio(*arguments)
            assert ran.returncode == 0, ran.stderr
        return tmp_path / "session"

    return capture


@pytest.mark.slow
def test_injected_errors_of_the_arm_are_recovered(gonio, tmp_path, captured):
    sizes = "\n".join(f"arm_view_{name} = {value}" for name, value in INJECTED.items())
    (tmp_path / "off.toml").write_text(sizes)
    session = captured(RIG, "rings:0x1,25x3,40x3,58x3", "--imperfections", "off.toml")
    ran = gonio("geometry")
    assert ran.returncode == 0, ran.stderr
    assert "corners in 10 of 10 views" in ran.stdout
    assert "within limits" in ran.stdout
    found = json.loads((tmp_path / "geometry.json").read_text())["view"]
    for name, value in INJECTED.items():
        tolerance = 3.0 if name == "distance_mm" else 0.05 if name.endswith("mm") else 0.03
        assert found[name] == pytest.approx(value, abs=tolerance), name
        line = next(line for line in ran.stdout.splitlines() if line.startswith(name))
        assert f"{value:g}" in line.split()
    assert worst_direction_deg(gonio, session) > 0.3
    assert worst_direction_deg(gonio, session, "--geometry", "geometry.json") < 0.01
    # the session keeps it
    assert worst_direction_deg(gonio, session) < 0.01


def worst_direction_deg(gonio, root, *options):
    """Reduce, and return how far a sample's view is from where the camera truly was."""
    ran = gonio("reduce", *options)
    assert ran.returncode == 0, ran.stderr
    samples = Samples.load(root / "samples.nc")
    with Session(root).journal() as journal:
        shots = {record.shot_index: record for record in journal.frames() if record.role == "shot"}
    arm, reach_mm = Alignment(**INJECTED), 1000.0 * default_rig().camera.distance_m
    angles = []
    for index, view in zip(samples.shot_index, samples.view, strict=True):
        eye = arm.pose(shots[index].view_theta_deg, shots[index].view_phi_deg).place(reach_mm)
        angles.append(math.asin(np.linalg.norm(np.cross(view, normalize(eye)))))
    return math.degrees(max(angles))


FOREIGN = {
    "other rig": ({"rig_sha256": "0" * 64}, True, "is of rig 000000000000, not"),
    "changed": ({"focal_px": 1e4}, False, "has changed since it was written"),
}


@pytest.mark.parametrize(("change", "hashed", "message"), FOREIGN.values(), ids=FOREIGN)
def test_a_geometry_of_another_rig_or_a_changed_one_is_refused(tmp_path, change, hashed, message):
    rig, path = default_rig(), tmp_path / "geometry.json"
    Geometry.of(rig, adjust(FINE, corners_seen(FINE, ALIGNED))).save(path)
    content = json.loads(path.read_text()) | change
    if hashed:
        del content["sha256"]
        Geometry.model_validate(content).save(path)
    else:
        path.write_text(json.dumps(content))
    with pytest.raises(BadFileError, match=message):
        Geometry.load(path, rig)


def test_the_demo_s_sensor_keeps_its_rig_file_s_geometry(gonio, captured):
    captured(default_rig_text(), "rings:0x1")
    ran = gonio("geometry")
    assert ran.returncode == 2
    assert "a module of the board's markers is 2.0 px, and 3 are needed" in ran.stderr
    assert "leave the geometry as the rig file has it" in ran.stderr
