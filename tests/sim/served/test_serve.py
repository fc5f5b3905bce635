"""A served twin from its start to its end, and what a person does at it."""

import os
import select
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import serial
import tifffile
import tomli_w

from gonio.clock import SystemClock, VirtualClock
from gonio.devices import Arm, FolderCamera, LampHead, LocalFolder
from gonio.errors import RegisterError, TransportTimeoutError
from gonio.plan import LampSetting
from gonio.rig import default_rig
from sim.camera import SimCamera
from sim.imperfections import BY_NAME
from sim.materials import load_material
from sim.twin import Twin

MODE, ERROR, INPUTS, WATCHDOG = 0x0002, 0x000E, 0x000F, 0x0010
POSE = {"view_theta": 30.0, "view_phi": 20.0, "light_theta": 45.0, "light_phi": 180.0}


class ClientBus:
    """The drivers' bus over a client of another library."""

    def __init__(self, client):
        self.client = client

    def read(self, unit, address, count):
        return self._checked(unit, address, self.client.read(unit, address, count))

    def write(self, unit, address, values):
        single = len(values) == 1
        self._checked(unit, address, self.client.write(unit, address, *values, single=single))

    def _checked(self, unit, address, answer):
        if answer == "silence":
            raise TransportTimeoutError(f"unit {unit}: no reply")
        if isinstance(answer, int):
            raise RegisterError(unit, address, answer)
        return answer


class Line:
    """The drivers' line over pyserial."""

    def __init__(self, port):
        self.port = port

    def send(self, line):
        self.port.write(line + b"\n")

    def receive(self, timeout_s):
        self.port.timeout = timeout_s
        answer = self.port.readline()
        if not answer.endswith(b"\r\n"):
            raise TransportTimeoutError("lamps: no answer")
        return answer[:-2]


def tell(*words):
    """Run `gonio sim`; return exit code and what it complains of."""
    done = subprocess.run(
        [sys.executable, "-m", "gonio", "sim", *map(str, words)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    return done.returncode, done.stderr


def light(line):
    """Light one lamp."""
    for request in (b"LED1:CURR 700", b"LED1:STAT ON"):
        line.send(request)
        assert line.receive(1.0) == b"OK"


def expose(line, exposure_us=1000):
    """Take a frame; return its number."""
    line.send(b"TRIG:EXP %d" % exposure_us)
    return int(line.receive(1.0).split()[1])


def frame_of(served, number):
    path = served.folder / "frames" / f"frame_{number:06d}.dng"
    until = time.monotonic() + 10.0
    while not path.exists():
        assert time.monotonic() < until, f"no {path.name}"
    return path


def test_what_it_prints_is_what_there_is(serve):
    served = serve()
    rig = served.rig
    assert f"127.0.0.1:{rig.arm.port}" in served.said
    assert f"gonio capture --rig {served.folder / 'rig.toml'}" in served.next
    assert rig.camera.folder == str(served.folder / "frames")
    assert rig.lamps.device == str(served.folder / "lamps")
    assert rig.holder.changer == "command"
    assert rig.holder.changer_command[-4:] == ("place", "{what}", "--at", str(served.folder))
    with np.load(served.folder / "truth.npz") as truth:
        assert truth["values"].shape == (81, 81, 3)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("options", [(), ("--rtu",)])
def test_it_ends_cleanly_while_a_client_is_there(serve, connect, number, options):
    served = serve(*options)
    if not options:
        assert connect(served).read(1, MODE) == [0]
    code, out, err = served.end(number)
    assert (code, err) == (0, "")
    assert "the twin is gone, after 0 frames" in out
    left = {path.name for path in served.folder.iterdir()}
    assert left == {"rig.toml", "truth.npz", "twin.json", "frames"}


def test_the_drivers_work_over_its_wires(serve, connect, tmp_path):
    served = serve("--speed", "20")
    rig, clock = served.rig, SystemClock()
    with serial.Serial(rig.lamps.device, 115200) as port:
        arm = Arm(ClientBus(connect(served)), rig, clock)
        lamps = LampHead(Line(port), rig, clock)
        camera = FolderCamera(LocalFolder(served.folder / "frames"), lamps, rig, clock)
        lamps.identify()
        camera.prepare()
        arm.enable()
        arm.home()
        arm.move(POSE)
        measured = arm.angles_deg()
        lamps.apply([LampSetting(n=1, mA=350.0)])
        frame = camera.expose(0.02)
        camera.fetch(frame, tmp_path / "first.dng")
        arm.release()
    for name, degrees in POSE.items():
        assert measured[name] == pytest.approx(degrees, abs=rig.axis[name].in_position_deg)
    assert frame.flux[0] == pytest.approx(0.5, abs=0.05)
    assert tifffile.imread(tmp_path / "first.dng").shape == (160, 160)


def test_a_frame_lies_in_the_folder(serve, connect):
    served = serve()
    with serial.Serial(served.rig.lamps.device, 115200) as port:
        number = expose(Line(port))
        with tifffile.TiffFile(frame_of(served, number)) as frame:
            assert frame.pages[0].shape == (160, 160)


def test_started_again_it_has_the_same_rig_file_and_other_frames(serve):
    frames, rigs = [], []
    for _ in range(2):
        served = serve()
        rigs.append(served.rig)
        with serial.Serial(served.rig.lamps.device, 115200) as port:
            path = frame_of(served, expose(Line(port)))
            frames.append(path.read_bytes())
            path.unlink()
        served.end()
    assert rigs[0] == rigs[1]
    assert frames[0] != frames[1]


def test_after_a_kill_it_starts_again(serve):
    served = serve("--rtu")
    served.end(signal.SIGKILL)
    assert "Modbus RTU" in serve("--rtu").said
    assert tell("door", "closed", "--at", served.folder) == (0, "")


def test_a_person_opens_the_door_and_closes_it(serve, connect):
    served = serve()
    client = connect(served)
    for state, expected in (("open", 8), ("closed", 0)):
        assert tell("door", state, "--at", served.folder) == (0, "")
        assert client.read(1, INPUTS)[0] & 8 == expected


def test_without_power_no_unit_is_there(serve, connect):
    served = serve()
    client = connect(served)
    client.write(1, MODE, 1)
    assert tell("power", "off", "--at", served.folder) == (0, "")
    assert client.read(1, MODE) == 0x0B
    assert tell("power", "on", "--at", served.folder) == (0, "")
    assert client.read(1, MODE) == [0]


def test_what_lies_in_the_holder_is_what_a_frame_shows(serve):
    served = serve("--material", "near-mirror")
    levels = {}
    with serial.Serial(served.rig.lamps.device, 115200) as port:
        line = Line(port)
        for n in range(1, 12):
            for request in (b"LED%d:CURR 700" % n, b"LED%d:STAT ON" % n):
                line.send(request)
                assert line.receive(1.0) == b"OK"
        for what in ("reference", "sample"):
            assert tell("place", what, "--at", served.folder) == (0, "")
            number = expose(line, 20000)
            levels[what] = tifffile.imread(frame_of(served, number)).mean()
            line.send(b"TRIG:STAT?")
            assert line.receive(1.0).startswith(b"DONE")
    assert levels["reference"] > levels["sample"] + 30


def test_an_imperfect_twin_is_the_same_in_process_and_served(serve, tmp_path):
    served = serve("--imperfections", "all", "--speed", "20", "--seed", "3")
    with serial.Serial(served.rig.lamps.device, 115200) as port:
        over_wires = frame_of(served, expose(Line(port), 10_000_000)).read_bytes()
    clock, rig = VirtualClock(), default_rig()
    camera = SimCamera(rig, load_material("wood-veneer"), 3, BY_NAME["all"].of_camera)
    twin = Twin(rig, camera, clock, tmp_path, 3, imperfections=BY_NAME["all"])
    twin.line.send(b"TRIG:EXP 10000000")
    assert twin.line.receive(1.0).startswith(b"OK")
    clock.sleep(11.0)
    assert (tmp_path / "frame_000001.dng").read_bytes() == over_wires


REFUSED = {
    "a folder of something else": (("--folder", "."), "is no folder of a served twin"),
    "an unknown material": (("--material", "cheese"), "material 'cheese' is not known"),
    "unknown imperfections": (("--imperfections", "some"), "use none, mild, all, or the path"),
    "a port of nobody": (("--rtu", "--port", "5020"), "leave one out"),
    "no rig file": (("--rig", "missing.toml"), "no such file"),
}


@pytest.mark.parametrize(("options", "message"), REFUSED.values(), ids=REFUSED)
def test_refusals(gonio, tmp_path, options, message):
    (tmp_path / "mine.txt").write_text("not a twin's")
    done = gonio("sim", "serve", *options)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_a_second_twin_in_one_folder_or_at_one_port_is_refused(serve, gonio, tmp_path):
    served = serve()
    again = gonio("sim", "serve", "--folder", served.folder)
    assert again.returncode == 2
    assert "another gonio sim serve runs there" in again.stderr
    beside = gonio("sim", "serve", "--folder", "other", "--port", served.rig.arm.port)
    assert beside.returncode == 2
    assert "choose another with --port" in beside.stderr
    assert tell("door", "open", "--at", served.folder) == (0, "")


@pytest.mark.parametrize("words", [("place", "sample"), ("door", "open"), ("power", "off")])
def test_nothing_is_done_where_nothing_is_served(tmp_path, words):
    code, err = tell(*words, "--at", tmp_path)
    assert code == 2
    assert "no twin is served there" in err


@pytest.fixture
def large(tmp_path):
    """A rig file whose frames take seconds to render."""
    rig = default_rig().model_dump(mode="json", exclude_none=True)
    rig["camera"] |= {"width": 1500, "height": 1500, "focal_px": 37500, "centre_px": [749.5, 749.5]}
    (tmp_path / "large.toml").write_text(tomli_w.dumps(rig))
    return str(tmp_path / "large.toml")


def test_it_answers_while_it_renders(serve, connect, large):
    served = serve("--rig", large)
    client = connect(served)
    client.client.timeout = 0.5
    with serial.Serial(served.rig.lamps.device, 115200) as port:
        line = Line(port)
        light(line)
        number = expose(line)
        path = served.folder / "frames" / f"frame_{number:06d}.dng"
        until = time.monotonic() + 20.0
        while not path.exists():
            assert client.read(1, MODE) == [0]
            assert time.monotonic() < until


def test_a_watchdog_counts_the_hosts_time(serve, connect):
    served = serve("--speed", "100")
    client = connect(served)
    for word in (0x0006, 0x0007, 0x000F):
        client.write(1, 0x0000, word, single=True)
    client.write(1, WATCHDOG, 1000, single=True)
    until = time.monotonic() + 0.3
    while time.monotonic() < until:
        # others are asked meanwhile: it is the unit's own watchdog
        client.read(2, MODE)
    assert client.read(1, ERROR) == [0]


def test_a_frame_that_cannot_be_written_is_told_and_nothing_ends(serve, connect):
    served = serve()
    (served.folder / "frames").rmdir()
    with serial.Serial(served.rig.lamps.device, 115200) as port:
        expose(Line(port))
    complaint = served.process.stderr.readline().decode()
    assert "frame_000001.dng: cannot be written (No such file or directory)" in complaint
    assert connect(served).read(1, MODE) == [0]
    assert served.end()[0] == 0


def test_ctrl_c_while_a_frame_is_rendered(serve, large):
    # the file begins to be rendered within 0.1 s of the twin's time, and that takes a second
    served = serve("--rig", large, "--speed", "100")
    with serial.Serial(served.rig.lamps.device, 115200) as port:
        line = Line(port)
        light(line)
        expose(line)
        for _ in range(200):
            line.send(b"LED1:FLUX?")
            line.receive(1.0)
    code, out, err = served.end()
    assert (code, err) == (0, "")
    assert "after 1 frame\n" in out


def test_a_line_on_a_terminal_says_what_it_does(serve, connect):
    ours, theirs = os.openpty()
    os.set_blocking(ours, False)
    served = serve("--speed", "20", stderr=theirs)
    said = ""

    def until_it_says(text):
        nonlocal said
        while text not in said:
            assert select.select([ours], [], [], 5.0)[0], said
            said += os.read(ours, 4096).decode()

    try:
        until_it_says("0 frames, 0 lamps lit, sample in the holder; nothing moves")
        client = connect(served)
        for address, word in ((0, 6), (0, 7), (0, 15), (2, 6), (0, 31)):
            client.write(2, address, word, single=True)
        with serial.Serial(served.rig.lamps.device, 115200) as port:
            light(Line(port))
            expose(Line(port), 20_000_000)
            until_it_says("1 lamp lit, shutter open, sample in the holder; view_phi at ")
            until_it_says("1 frame, ")
        assert served.end()[0] == 0
    finally:
        os.close(ours)
        os.close(theirs)
