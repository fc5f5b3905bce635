"""The arm's driver at a Modbus server of another library, behind which the twin's drives are."""

import socket
import threading

import pytest
from pyModbusTCP.server import DataHandler, ModbusServer

from gonio.clock import SystemClock, VirtualClock
from gonio.devices import Arm, Troubles
from gonio.errors import DeviceFaultError, RegisterError
from gonio.rig import AXES, Rig, default_rig
from gonio.wire import ModbusBus
from sim.registers import NO_SUCH_UNIT, RefusedError
from sim.served.present import Present, WireClock
from sim.twin import Twin

SPEED = 20
POSE = {"view_theta": 30.0, "view_phi": 200.0, "light_theta": 45.0, "light_phi": 10.0}


class Drives(DataHandler):
    """pyModbusTCP's way to registers that are not its own; its clients have a thread each."""

    def __init__(self, rig, folder):
        super().__init__()
        clock = VirtualClock()
        self.twin = Twin(rig, None, clock, folder, 1, wires=WireClock(clock))
        self.twin.hurry(SPEED)
        self.units = {rig.axis[name].unit: self.twin.drives[name] for name in AXES}
        self.clock, self.present = clock, Present(clock, SPEED)
        self.lock, self.hang_up_in = threading.Lock(), -1

    def read_h_regs(self, address, count, srv_info):
        return self._answer(srv_info, lambda drive: drive.read(address, count, self.clock.now()))

    def write_h_regs(self, address, words_l, srv_info):
        return self._answer(srv_info, lambda drive: drive.write(address, words_l, self.clock.now()))

    def _answer(self, info, act):
        with self.lock:
            self.hang_up_in -= 1
            if self.hang_up_in == 0:
                raise ModbusServer.NetworkError
            self.present.catch_up()
            self.twin.advance_drives(self.clock.now())
            drive = self.units.get(info.recv_frame.mbap.unit_id)
            if drive is None:
                return DataHandler.Return(exp_code=NO_SUCH_UNIT)
            try:
                return DataHandler.Return(exp_code=0, data=act(drive))
            except RefusedError as refused:
                return DataHandler.Return(exp_code=refused.code)


class Served:
    """Drives behind a real port, and a driver at it."""

    def __init__(self, folder):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        rig = default_rig()
        self.rig = rig.model_copy(
            update={"arm": rig.arm.model_copy(update={"host": "127.0.0.1", "port": port})}
        )
        self.drives = Drives(self.rig, folder)
        self.server = ModbusServer("127.0.0.1", port, no_block=True, data_hdl=self.drives)
        self.server.start()
        self.troubles, self.mended = Troubles(), []
        self.troubles.listener = lambda what, did: self.mended.append(f"{what}, {did}")
        self.bus = ModbusBus(self.rig.arm)
        self.arm = self.driver(self.rig)

    def driver(self, rig):
        return Arm(self.bus, rig, SystemClock(), self.troubles)

    def close(self):
        self.bus.close()
        self.server.stop()


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    made = Served(tmp_path_factory.mktemp("frames"))
    made.arm.enable()
    made.arm.home()
    yield made
    made.close()


def test_moves_arrive_where_the_encoders_say(served):
    for pose in (POSE, dict.fromkeys(POSE, 20.0)):
        served.arm.move(pose)
        assert served.arm.angles_deg() == pytest.approx(pose, abs=0.03)
        at = served.drives
        with at.lock:
            now = at.clock.now()
            true = {name: drive.axis.actual_deg(now) for name, drive in at.twin.drives.items()}
        assert true == pytest.approx(pose, abs=0.1)
    assert not served.mended


def test_refusals_of_the_other_library_are_understood(served):
    reads, codes = {(9, 0): 11, (1, 0x20): 2}, {}
    for unit, address in reads:
        with pytest.raises(RegisterError) as caught:
            served.bus.read(unit, address, 1)
        codes[unit, address] = caught.value.code
    assert codes == reads
    with pytest.raises(RegisterError) as caught:
        served.bus.write(1, 4, [7])  # half a value
    assert caught.value.code == 3


def test_an_axis_at_a_unit_that_is_not_there_is_named(served):
    data = served.rig.model_dump()
    data["axis"]["view_phi"]["unit"] = 9
    with pytest.raises(DeviceFaultError, match=r"unit 9, .* exception 11"):
        served.driver(Rig.model_validate(data)).enable()
    served.arm.enable()


def test_a_connection_that_breaks_while_the_arm_moves_is_made_anew(served):
    goal = served.arm.angles_deg()["view_phi"] + 100.0
    # the axis is on its way by then, and its state is asked for
    served.drives.hang_up_in = 12
    served.arm.move({"view_phi": goal})
    assert served.arm.angles_deg()["view_phi"] == pytest.approx(goal, abs=0.03)
    assert [mended.partition("; ")[0] for mended in served.mended] == [
        f"arm: no connection to 127.0.0.1:{served.rig.arm.port}"
    ]


def test_a_stop_leaves_all_drives_disabled(served):
    served.arm.enable()
    served.arm.stop()
    assert [served.bus.read(unit, 1, 1)[0] & 0x4F for unit in (1, 2, 3, 4)] == [0x40] * 4
