"""A rig whose camera is the virtual one that the wheel of gphoto2 carries, by the command line."""

import threading

import pytest

from gonio.capture.usage import usages_of
from gonio.session import Session
from tests.tiny import tiny_dng

EXPOSURE_S = 0.02
pytestmark = pytest.mark.parametrize("served", ["tcp"], indirect=True)


@pytest.fixture
def rig(served, tmp_path, monkeypatch):
    """A rig file for the served twin's arm and lamps, and the virtual camera."""
    card = tmp_path / "card"
    card.mkdir()
    (card / "A.JPG").write_bytes(tiny_dng(0, EXPOSURE_S))
    monkeypatch.setenv("VCAMERADIR", str(card))
    text = served.rig.read_text()
    text = text.replace('kind = "folder"', 'kind = "gphoto2"')
    lines = [line for line in text.splitlines() if not line.startswith("folder = ")]
    start = next(number for number, line in enumerate(lines) if line.startswith("exposures_s"))
    end = next(number for number in range(start, len(lines)) if lines[number].endswith("]"))
    lines[start : end + 1] = [f"exposures_s = [{EXPOSURE_S}]"]
    path = tmp_path / "gphoto.toml"
    path.write_text("\n".join(lines))
    return path


@pytest.fixture
def new_pictures(rig):
    """Have the virtual camera take another picture every few milliseconds."""
    card, over = rig.parent / "card", threading.Event()

    def change():
        number = 0
        while not over.wait(0.005):
            number += 1
            (rig.parent / "next").write_bytes(tiny_dng(number, EXPOSURE_S))
            (rig.parent / "next").replace(card / "A.JPG")

    thread = threading.Thread(target=change)
    thread.start()
    yield
    over.set()
    thread.join()


def ok(result):
    assert result.returncode == 0, (result.stdout, result.stderr)
    return " ".join(result.stdout.split())


def test_check_says_which_camera_it_is_and_takes_a_frame(gonio, rig):
    said = ok(gonio("rig", "check", "--exercise", "--rig", rig))
    assert "GP VC, serial 0.1, firmware 2.5.11" in said
    assert "battery 50%" in said
    assert "the camera has all of the rig file" in said
    assert "number 1, 680 B, whole" in said


def test_check_says_which_exposure_is_missing(gonio, rig):
    rig.write_text(rig.read_text().replace("[0.02]", "[0.02, 0.3]"))
    result = gonio("rig", "check", "--rig", rig)
    assert result.returncode == 3
    assert "has no exposure of 0.3 s" in " ".join(result.stdout.split())


def test_check_without_a_camera(gonio, rig, monkeypatch):
    monkeypatch.delenv("VCAMERADIR")
    result = gonio("rig", "check", "--rig", rig)
    assert result.returncode == 3
    assert "none is found at USB" in " ".join(result.stdout.split())


def test_a_whole_capture(gonio, rig, new_pictures, tmp_path):
    ok(gonio("plan", "--density", "2", "--criterion", "farthest", "--rig", rig, "--no-page"))
    ok(gonio("capture", "--rig", rig))
    with Session(tmp_path / "session").journal() as journal:
        frames, (usage,) = journal.frames(), usages_of(journal)
    # files come through the cable while the arms stand
    assert usage.hidden_s == pytest.approx(0.0, abs=1e-6)
    assert usage.waiting_s > 0.0
    shots = [record for record in frames if record.role == "shot"]
    assert {record.shot_index for record in shots} == {0, 1, 2, 3}
    assert all(min(record.flux) > 0.5 for record in shots)
    assert len({record.sha256 for record in frames}) == len(frames)
