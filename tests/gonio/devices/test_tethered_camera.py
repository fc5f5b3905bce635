"""The camera at a cable, on a stand-in that has what the virtual camera has not: a real shutter.

Its pictures take their time on the twin's clock, and it can be told to be slow, forgetful or gone.
"""

from collections import deque

import pytest

from gonio.devices import TetheredCamera, Troubles
from gonio.devices.shutter_speeds import seconds_of
from gonio.errors import (
    DeviceFaultError,
    FrameLostError,
    TransportLostError,
    TransportTimeoutError,
)
from gonio.transports import CameraPort
from tests.tiny import tiny_dng

WRITING_S = 0.3
SPEEDS = ["1/100", "1/10", "1", "30", "bulb"]


class StandIn:
    """A camera that writes a raw file some time after its shutter has closed."""

    def __init__(self, clock):
        self.clock = clock
        self.card = {"/card/DCIM/IMG_0007.DNG": b"of an earlier run"}
        self.settings = {"shutterspeed": "1/10"}
        self.events, self.fails, self.asked = deque(), {}, []
        self.is_open, self.writing_s, self.keeps_speed, self.count = False, WRITING_S, False, 10
        self.sent = lambda data: data

    def connect(self):
        self._ask("connect")
        self.events.clear()

    def read(self, name):
        self._ask("read")
        return self.settings[name]

    def write(self, name, value):
        self._ask("write")
        if not self.keeps_speed:
            self.settings[name] = value

    def choices(self, name):
        self._ask("choices")
        return SPEEDS

    def files(self):
        self._ask("files")
        return {*self.card}

    def trigger(self):
        self._ask("trigger")
        open_s, now = seconds_of(self.settings["shutterspeed"]), self.clock.now()
        self.count, self.is_open = self.count + 1, True
        name, data = f"/card/DCIM/IMG_{self.count:04d}.DNG", tiny_dng(self.count, open_s)
        self.clock.call_at(now + open_s, lambda: setattr(self, "is_open", False))
        self.clock.call_at(now + open_s + self.writing_s, lambda: self.add(name, data))

    def add(self, name, data):
        self.card[name] = data
        self.events.append(name)

    def new_file(self, timeout_s):
        self._ask("new_file")
        return self.events.popleft() if self.events else None

    def download(self, path, target):
        self._ask("download")
        target.write_bytes(self.sent(self.card[path]))
        return len(self.card[path])

    def delete(self, path):
        self._ask("delete")
        del self.card[path]

    def close(self):
        pass

    def _ask(self, what):
        self.asked.append(what)
        if self.fails.get(what):
            raise self.fails[what].pop(0)


@pytest.fixture
def port(bench):
    return StandIn(bench.clock)


@pytest.fixture
def noted():
    return []


@pytest.fixture
def camera(port, bench, rig_with, noted):
    keys = {"kind": "gphoto2", "folder": "", "exposures_s": [0.01, 0.1, 1.0, 30.0]}
    troubles = Troubles()
    troubles.listener = lambda what, did: noted.append((what, did))
    camera = TetheredCamera(port, bench.lamps, rig_with("camera", **keys), bench.clock, troubles)
    assert camera.prepare() == 1
    return camera


@pytest.fixture
def take(camera, tmp_path):
    """Take a frame: take(exposure_s) returns its file."""
    count = 0

    def one(exposure_s=0.1):
        nonlocal count
        count += 1
        path = tmp_path / f"{count}.dng"
        camera.fetch(camera.expose(exposure_s), path)
        return path

    return one


def test_it_is_a_port_as_the_real_one_is(port):
    assert isinstance(port, CameraPort)


@pytest.mark.parametrize("exposure_s", [0.01, 1.0, 30.0])
def test_the_shutter_has_closed_when_an_exposure_is_over(camera, port, bench, exposure_s):
    began = bench.clock.now()
    camera.expose(exposure_s)
    assert not port.is_open
    assert bench.clock.now() - began == pytest.approx(exposure_s + WRITING_S, abs=0.2)


def test_a_raw_file_is_fetched_and_then_deleted(take, port, noted):
    assert take(0.01).read_bytes() == tiny_dng(11, 0.01)
    assert {*port.card} == {"/card/DCIM/IMG_0007.DNG"}, "what it did not take it leaves alone"
    assert noted == []


def test_a_late_file_is_not_taken_for_the_next_frame(take, port, bench, noted):
    port.writing_s = 12.0
    with pytest.raises(FrameLostError, match="frame 1 did not come within 10 s"):
        take()
    port.writing_s = WRITING_S
    bench.clock.sleep(5.0)
    assert take().read_bytes() == tiny_dng(12, 0.1)
    assert "/card/DCIM/IMG_0011.DNG" in port.card


def test_a_late_file_that_is_announced_during_the_next_exposure(take, port, bench):
    port.writing_s = 1e6
    with pytest.raises(FrameLostError, match="frame 1 did not come within 10 s"):
        take()
    port.writing_s, late = WRITING_S, "/card/DCIM/IMG_0011.DNG"
    port.card[late] = tiny_dng(11, 0.1)
    bench.at(0.1, lambda: port.events.append(late))
    assert take().read_bytes() == tiny_dng(12, 0.1)
    assert late in port.card


def test_a_file_of_no_exposure_here_is_passed_over(take, port, bench, noted):
    take()
    port.add("/card/DCIM/IMG_0900.DNG", b"somebody pressed the button")
    assert take().read_bytes() == tiny_dng(12, 0.1)
    ((what, did),) = noted
    assert what == "camera: /card/DCIM/IMG_0900.DNG: came late, or of no exposure here"
    assert did == "left there"
    assert "/card/DCIM/IMG_0900.DNG" in port.card


def test_a_stale_file_is_never_taken(take, port, bench, noted):
    bench.at(0.2, lambda: port.events.append("/card/DCIM/IMG_0007.DNG"))
    assert take().read_bytes() == tiny_dng(11, 0.1)
    assert noted == [
        ("camera: /card/DCIM/IMG_0007.DNG: was there before this exposure", "passed over")
    ]


def test_a_file_that_is_announced_twice_counts_once(take, port, bench, noted):
    bench.at(0.1 + WRITING_S + 0.05, lambda: port.events.append("/card/DCIM/IMG_0011.DNG"))
    take()
    bench.clock.sleep(1.0)
    assert take().read_bytes() == tiny_dng(12, 0.1)
    assert [did for _, did in noted] == ["passed over"]


def test_a_file_that_comes_short_is_refused_and_kept(take, port):
    port.sent = lambda data: data[:-1]
    with pytest.raises(FrameLostError, match=r"IMG_0011.DNG: (\d+) of \d+ bytes came"):
        take()
    assert "/card/DCIM/IMG_0011.DNG" in port.card


def test_a_bit_that_flips_on_the_way_is_seen_by_the_checksum(take, port):
    port.sent = lambda data: data[:-5] + bytes([data[-5] ^ 4]) + data[-4:]
    with pytest.raises(FrameLostError, match="has other pixels than the camera wrote"):
        take()


def test_a_speed_that_does_not_hold_is_refused(camera, port):
    port.keeps_speed = True
    with pytest.raises(DeviceFaultError, match=r"shutterspeed says 1/10 after it was set to 1; tu"):
        camera.expose(1.0)
    assert "trigger" not in port.asked


ONCE = [
    ("read", TransportTimeoutError("camera: does not answer"), "asked again"),
    ("download", TransportTimeoutError("camera: does not answer"), "asked again"),
    ("new_file", TransportTimeoutError("camera: does not answer"), "asked again"),
    ("read", TransportLostError("camera: is gone"), "waits up to 60 s"),
    ("download", TransportLostError("camera: is gone"), "waits up to 60 s"),
    ("delete", DeviceFaultError("camera: the card is locked"), "left there"),
]


@pytest.mark.parametrize(("request_", "error", "did"), ONCE)
def test_what_fails_once_is_asked_again(take, port, noted, request_, error, did):
    port.fails[request_] = [error]
    assert take().read_bytes() == tiny_dng(11, 0.1)
    assert noted == [(str(error), did)]


def test_a_trigger_is_never_repeated_and_what_came_of_it_never_taken(take, port, bench):
    port.fails["trigger"] = [TransportTimeoutError("camera: does not answer")]
    with pytest.raises(TransportTimeoutError):
        take()
    assert port.asked.count("trigger") == 1
    bench.at(0.01, lambda: port.add("/card/DCIM/IMG_0500.DNG", b"it had heard"))
    bench.clock.sleep(1.0)
    assert take().read_bytes() == tiny_dng(11, 0.1)


def test_a_camera_that_stays_away(camera, port, bench):
    port.fails["read"] = [TransportLostError("camera: is gone")] * 200
    began = bench.clock.now()
    with pytest.raises(TransportLostError):
        camera.expose(0.1)
    assert bench.clock.now() - began == pytest.approx(60.0, abs=2.0)
