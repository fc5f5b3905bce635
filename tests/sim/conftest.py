import pytest

from gonio.clock import VirtualClock
from gonio.errors import RegisterError
from gonio.rig import default_rig
from sim.twin import Twin


class BlankCamera:
    """Notes what it is asked for and makes a file of a few bytes."""

    def __init__(self):
        self.asked = []

    def frame(self, **scene):
        self.asked.append(scene)
        return b"frame"


class Unit:
    """One unit of the bus in raw words; every request takes 2 ms."""

    def __init__(self, twin, clock, unit):
        self.bus, self.clock, self.unit = twin.bus, clock, unit
        self.drive = list(twin.drives.values())[unit - 1]

    def read(self, address, count=1):
        words = self.bus.read(self.unit, address, count)
        return words[0] if count == 1 else words

    def read_int32(self, address):
        high, low = self.bus.read(self.unit, address, 2)
        value = high << 16 | low
        return value - (1 << 32) if value >> 31 else value

    def write(self, address, *words):
        self.bus.write(self.unit, address, list(words))

    def refusal(self, function, *arguments):
        try:
            function(*arguments)
        except RegisterError as error:
            return error.code
        return None

    def control(self, *words):
        for word in words:
            self.write(0x0000, word)

    @property
    def status(self):
        return self.read(0x0001)

    @property
    def state(self):
        """The state under the masks of the profile."""
        low, high = self.status & 0x4F, self.status & 0x6F
        return low if low in (0x00, 0x40, 0x0F, 0x08) else high

    def bits(self, *numbers):
        status = self.status
        return tuple(status >> number & 1 for number in numbers)

    def enable(self):
        self.control(0x06, 0x07, 0x0F)
        assert self.state == 0x27

    def home(self):
        self.write(0x0002, 6)
        self.control(0x1F)
        self.clock.sleep(60.0)
        assert self.bits(10, 12, 13) == (1, 1, 0)
        self.control(0x0F)
        self.write(0x0002, 1)

    def target(self, counts):
        self.write(0x0004, *divmod(counts & 0xFFFFFFFF, 1 << 16))

    def go(self, counts, control=0x1F):
        """Offer a set-point; return whether it was acknowledged."""
        self.control(0x0F)
        self.target(counts)
        self.control(control)
        return bool(self.status & 0x1000)


@pytest.fixture
def clock():
    return VirtualClock()


@pytest.fixture
def camera():
    return BlankCamera()


@pytest.fixture
def twin(clock, camera, tmp_path):
    return Twin(default_rig(), camera, clock, tmp_path, seed=1)


@pytest.fixture
def units(twin, clock):
    """The four units by id."""
    return {number: Unit(twin, clock, number) for number in (1, 2, 3, 4)}


@pytest.fixture
def unit(units):
    """View theta just after power-up: 2000 counts per deg, travel 4000 to 188000 counts."""
    return units[1]


@pytest.fixture
def homed(unit):
    """The same, enabled, homed and in profile position mode, at full speed."""
    unit.enable()
    unit.home()
    unit.write(0x0008, 0, 40000, 0, 40000)
    return unit
