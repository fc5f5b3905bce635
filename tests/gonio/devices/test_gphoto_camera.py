"""The camera at a cable, on the virtual camera that the wheel of gphoto2 carries.

It offers the files of a folder as a Nikon at USB, and gives the folder's one JPG as each picture;
what is in that file may be anything, so here it is a DNG. After 26 pictures its store is full until
it is connected anew, when it counts from the beginning.
"""

import contextlib
import gc
import sys
from types import SimpleNamespace

import pytest

from gonio.devices import TetheredCamera, Troubles
from gonio.errors import (
    BadInputError,
    DeviceFaultError,
    FrameLostError,
    MissingExtraError,
    TransportLostError,
)
from gonio.plan import LampSetting
from gonio.wire import GPhotoPort
from tests.tiny import tiny_dng

STORE = 26
ITS_OWN = "/store_00010001/A.JPG"


class VirtualCamera:
    """A virtual camera, its driver, and what the driver noted."""

    def __init__(self, folder, bench, rig):
        self.picture = folder / "A.JPG"
        self.taken = 0
        self.load(0, 0.01)
        self.port = GPhotoPort()
        self.noted = []
        troubles = Troubles()
        troubles.listener = lambda what, did: self.noted.append((what, did))
        self.driver = TetheredCamera(self.port, bench.lamps, rig, bench.clock, troubles)

    def load(self, number, exposure_s):
        """Have it take this picture from now on; all have to be of one size."""
        self.picture.write_bytes(tiny_dng(number, exposure_s))

    def take(self, target, exposure_s=0.01):
        self.taken += 1
        self.load(self.taken, exposure_s)
        self.driver.fetch(self.driver.expose(exposure_s), target)


@pytest.fixture
def camera_of(bench, tmp_path, monkeypatch, rig_with):
    """Make a virtual camera with these keys in the rig file: camera_of(exposures_s=[1.0])."""
    monkeypatch.setenv("VCAMERADIR", str(tmp_path / "card"))
    (tmp_path / "card").mkdir()
    # virtual cameras of one process share a store, and a traceback may keep an earlier one alive
    gc.collect()
    with contextlib.ExitStack() as stack:

        def make(**keys):
            given = {"kind": "gphoto2", "folder": "", "exposures_s": [0.01, 0.1, 1.0]} | keys
            camera = VirtualCamera(tmp_path / "card", bench, rig_with("camera", **given))
            stack.enter_context(contextlib.closing(camera.port))
            return camera

        yield make


@pytest.fixture
def camera(camera_of):
    return camera_of()


def test_it_says_who_it_is(camera):
    assert camera.driver.who() == ("GP", "VC", "0.1", "2.5.11", "50%")


def test_a_frame_is_fetched_whole_and_deleted_on_the_camera(camera, tmp_path):
    assert camera.driver.prepare() == 1
    camera.take(tmp_path / "shot.dng", 0.1)
    assert (tmp_path / "shot.dng").read_bytes() == tiny_dng(1, 0.1)
    assert camera.port.read("shutterspeed") == "0.1000s"
    assert camera.port.files() == {ITS_OWN}
    assert camera.noted == []


def test_the_light_is_that_of_the_lamps(camera, bench):
    bench.lamps.identify()
    bench.lamps.apply([LampSetting(n=3, mA=350.0)])
    began = bench.clock.now()
    frame = camera.driver.expose(1.0)
    assert frame.flux[2] == pytest.approx(0.532, abs=0.002)  # half the current, and cool
    assert {*frame.flux[:2], *frame.flux[3:]} == {0.0}
    assert bench.clock.now() - began == pytest.approx(1.0, abs=0.1)


def test_a_lamp_that_goes_out_spoils_the_frame(camera, bench):
    bench.lamps.identify()
    bench.lamps.apply([LampSetting(n=3, mA=350.0)])
    bench.at(0.5, lambda: bench.twin.lamps.break_circuit(3))
    with pytest.raises(DeviceFaultError, match=r"lamp 3 went out in frame 1 \(301"):
        camera.driver.expose(1.0)


def test_exposures_that_it_does_not_have_are_refused(camera_of):
    says = r"no exposure of 0\.03 s, the next are 0\.0200s, .*; change camera\.exposures_s"
    with pytest.raises(BadInputError, match=says):
        camera_of(exposures_s=[0.01, 0.03]).driver.prepare()


def settings(name, value):
    return {"settings": [{"name": name, "value": value}]}


def test_settings_of_the_rig_file_are_set_and_read_back(camera_of):
    camera = camera_of(**settings("f-number", "f/8"))
    assert camera.driver.wrong() == {"f-number": "f/2.8"}
    camera.driver.prepare()
    assert camera.port.read("f-number") == "f/8"
    assert camera.driver.wrong() == {}


@pytest.mark.parametrize(
    ("name", "value", "error", "says"),
    [
        ("f-number", "f/3", BadInputError, r"f-number cannot be 'f/3'; .* f/2\.8, f/3\.5"),
        ("iso", "100", DeviceFaultError, "camera: iso: .*; it has no such setting"),
        ("imagesize", "1024x768", DeviceFaultError, "camera: imagesize"),
    ],
)
def test_settings_that_it_does_not_take(camera_of, name, value, error, says):
    with pytest.raises(error, match=says) as caught:
        camera_of(**settings(name, value)).driver.prepare()
    assert "\n" not in str(caught.value)


def test_a_picture_taken_before_is_no_new_one(camera, tmp_path):
    camera.take(tmp_path / "first.dng")
    frame = camera.driver.expose(0.01)
    with pytest.raises(FrameLostError, match=r"has the ImageUniqueID of frame 1 \(/store"):
        camera.driver.fetch(frame, tmp_path / "second.dng")
    assert frame.name in camera.port.files(), "what is not vouched for is not deleted"


def test_the_same_number_after_a_restart_is_told_apart(camera, tmp_path):
    camera.take(tmp_path / "first.dng")
    camera.driver.prepare()
    again = camera.driver.expose(0.01)
    with pytest.raises(FrameLostError, match="ImageUniqueID of frame 1"):
        camera.driver.fetch(again, tmp_path / "second.dng")
    camera.driver.prepare()
    camera.take(tmp_path / "third.dng")


def test_a_picture_of_another_exposure_is_refused(camera, tmp_path):
    camera.load(1, 0.1)
    frame = camera.driver.expose(0.01)
    with pytest.raises(FrameLostError, match=r"was open 0\.1 s, not the 0\.01 s asked for"):
        camera.driver.fetch(frame, tmp_path / "shot.dng")


def test_a_truncated_picture_is_refused(camera, tmp_path):
    camera.picture.write_bytes(tiny_dng(1, 0.01)[:-20])
    frame = camera.driver.expose(0.01)
    with pytest.raises(FrameLostError, match=r"shot\.dng: has \d+ bytes of \d+"):
        camera.driver.fetch(frame, tmp_path / "shot.dng")
    assert frame.name in camera.port.files()


def test_no_file_in_time_and_all_well_when_it_is_connected_anew(camera_of, tmp_path, bench):
    camera = camera_of(file_timeout_s=1.0)
    for _ in range(STORE):
        camera.port.trigger()
        while camera.port.new_file(0.01) is None:
            pass
    began = bench.clock.now()
    with pytest.raises(FrameLostError, match="frame 1 did not come within 1 s"):
        camera.driver.expose(0.01)
    assert bench.clock.now() - began == pytest.approx(1.0, abs=0.2)
    camera.take(tmp_path / "next.dng")


def test_without_the_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "gphoto2", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'gonio\[gphoto2\]'"):
        GPhotoPort().connect()


@pytest.mark.parametrize(
    ("names", "error", "says"),
    [
        ([], TransportLostError, "none is found at USB; switch it on"),
        (["Make 1", "Make 2"], BadInputError, "several, Make 1 at usb:001,001, Make 2 at usb:001"),
    ],
)
def test_no_camera_and_one_too_many(monkeypatch, names, error, says):
    import gphoto2

    found = gphoto2.CameraList()
    for number, name in enumerate(names, 1):
        found.append(name, f"usb:001,00{number}")
    monkeypatch.setattr(gphoto2, "Camera", SimpleNamespace(autodetect=lambda: found))
    with pytest.raises(error, match=says):
        GPhotoPort().connect()
