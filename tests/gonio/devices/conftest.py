import pytest

from gonio.clock import VirtualClock
from gonio.devices import Arm, FolderCamera, LampHead, LocalFolder
from gonio.errors import TransportTimeoutError
from gonio.rig import Rig, default_rig
from sim.twin import Twin
from tests.tiny import TinyCamera


class TroubledBus:
    """A bus between driver and twin that counts requests and does what a test plans for some.

    `plan` maps the number of a request, from 0, to a function that is given the request to carry
    out; `answers` maps an address to a function of what the twin answered.
    """

    def __init__(self, bus):
        self.bus = bus
        self.plan = {}
        self.answers = {}
        self.written = []
        self.count = 0

    def read(self, unit, address, count):
        words = self._do(lambda: self.bus.read(unit, address, count))
        return self.answers.get(address, lambda unit, words: words)(unit, words)

    def write(self, unit, address, values):
        self.written.append((unit, address, list(values)))
        return self._do(lambda: self.bus.write(unit, address, values))

    def controlwords(self, unit):
        return [values[0] for to, address, values in self.written if (to, address) == (unit, 0)]

    def targets(self, unit):
        return [values for to, address, values in self.written if (to, address) == (unit, 4)]

    def _do(self, request):
        number, self.count = self.count, self.count + 1
        return self.plan.get(number, lambda request: request())(request)


class TroubledLine:
    """A serial line that spoils what a test plans: `out` and `back` map a line's number."""

    def __init__(self, line):
        self.line = line
        self.out = {}
        self.back = {}
        self.sent = []
        self.received = 0

    def send(self, line):
        number = len(self.sent)
        self.sent.append(line)
        spoiled = self.out.get(number, lambda line: line)(line)
        if spoiled is not None:
            self.line.send(spoiled)

    def receive(self, timeout_s):
        answer = self.line.receive(timeout_s)
        number, self.received = self.received, self.received + 1
        spoiled = self.back.get(number, lambda answer: answer)(answer)
        return self.receive(timeout_s) if spoiled is None else spoiled


def lost_reply(request):
    """Carry a request out and lose its reply."""
    request()
    raise TransportTimeoutError("bus: no reply within 0.5 s; check the cable")


def lost_request(_):
    """Lose a request before it arrives."""
    raise TransportTimeoutError("bus: no reply within 0.5 s; check the cable")


class Bench:
    """A twin with drivers on troubled transports."""

    def __init__(self, folder, driver_rig=None, twin_rig=None, seed=1):
        self.rig = driver_rig or default_rig()
        self.folder = folder / "frames"
        self.folder.mkdir(exist_ok=True)
        self.clock = VirtualClock()
        self.sensor = TinyCamera()
        self.twin = Twin(twin_rig or self.rig, self.sensor, self.clock, self.folder, seed)
        self.bus = TroubledBus(self.twin.bus)
        self.line = TroubledLine(self.twin.line)
        self.arm = Arm(self.bus, self.rig, self.clock)
        self.lamps = LampHead(self.line, self.rig, self.clock)
        self.camera = FolderCamera(LocalFolder(self.folder), self.lamps, self.rig, self.clock)

    def homed(self):
        self.arm.enable()
        self.arm.home()
        self.bus.count = 0
        self.bus.written.clear()
        return self

    def at(self, seconds, action):
        """Let something happen so many seconds from now."""
        self.clock.call_at(self.clock.now() + seconds, action)

    def states(self):
        return [self.twin.bus.read(unit, 1, 1)[0] & 0x6F for unit in (1, 2, 3, 4)]

    def true_deg(self):
        now = self.clock.now()
        self.states()
        return {name: drive.axis.actual_deg(now) for name, drive in self.twin.drives.items()}


def changed_rig(table, **keys):
    """Return the built-in rig with some keys of one table changed."""
    data = default_rig().model_dump()
    target = data
    for part in table.split("."):
        target = target[part]
    target.update(keys)
    return Rig.model_validate(data)


@pytest.fixture
def bench(tmp_path):
    return Bench(tmp_path)


@pytest.fixture
def homed(bench):
    return bench.homed()


@pytest.fixture
def make_bench(tmp_path):
    """Make a bench whose twin differs from the rig file: make_bench(driver_rig, twin_rig)."""
    return lambda *rigs: Bench(tmp_path, *rigs)


@pytest.fixture
def rig_with():
    return changed_rig


@pytest.fixture
def lose():
    """The two ways to lose something on the bus, by name."""
    return {"reply": lost_reply, "request": lost_request}
