"""The timing's file: written and read back, and refused where it is damaged or foreign."""

import json

import pytest

from gonio.errors import BadFileError
from gonio.files import canonical_json, sha256_bytes
from gonio.rig import default_rig
from gonio.timing import Timing, default_timing

TIMING = default_timing(default_rig())


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "rig-timing.json"
    TIMING.save(path)
    return path


def test_round_trip(saved):
    assert Timing.load(saved) == TIMING
    data = json.loads(saved.read_text())
    assert data["schema"] == "gonio.timing/1"
    assert data.pop("sha256") == sha256_bytes(canonical_json(data)) == TIMING.sha256


def put(*path):
    *where, key, value = path

    def edit(data):
        for step in where:
            data = data[step]
        data[key] = value

    return edit


EDITS = [
    # name, edit, what is said
    ("tampered", put("hold", "mean_s", 0.5), "sha256: does not match"),
    ("no hash", lambda data: data.pop("sha256"), "sha256: is missing"),
    ("another schema", put("schema", "gonio.plan/1"), "'gonio.plan/1', not 'gonio.timing/1'"),
    ("no axis", lambda data: data["axis"].pop("view_phi"), "axis.view_phi: is missing"),
    ("no speed", put("axis", "view_phi", "velocity_deg_s", 0.0), "view_phi.velocity_deg_s: 0.0 is"),
    ("no ramp", put("axis", "view_phi", "acceleration_deg_s2", 0), "acceleration_deg_s2: 0 is out"),
    ("jerks back", put("axis", "view_phi", "jerk_deg_s3", -1.0), "jerk_deg_s3: -1.0 is out"),
    ("before it began", put("read_out", "mean_s", -0.1), "read_out.mean_s: -0.1 is out"),
    ("no number", put("read_out", "mean_s", float("nan")), "read_out.mean_s: nan is out"),
    ("blind", put("white_level_s", 0.0), "white_level_s: 0.0 is out"),
    ("unknown key", put("colour", "red"), "colour: is not a known key"),
]


@pytest.mark.parametrize(("edit", "says"), [c[1:] for c in EDITS], ids=[c[0] for c in EDITS])
def test_a_damaged_file_is_refused_in_one_line(saved, edit, says):
    data = json.loads(saved.read_text())
    edit(data)
    saved.write_text(json.dumps(data))
    with pytest.raises(BadFileError, match=says) as caught:
        Timing.load(saved)
    assert str(caught.value).endswith("measure the rig with: gonio rig bench")
    assert "\n" not in str(caught.value)


FOREIGN = {
    "missing": (None, "no such file"),
    "no JSON": (b"{", "is not JSON"),
    "a list": (b"[1]", "no object at the top"),
    "binary": (b"\xff\xfe\x00", "is not text"),
    "empty": (b"{}", "has schema None"),
}


@pytest.mark.parametrize(("content", "says"), FOREIGN.values(), ids=FOREIGN)
def test_a_file_that_is_none(tmp_path, content, says):
    path = tmp_path / "rig-timing.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(BadFileError, match=says):
        Timing.load(path)
