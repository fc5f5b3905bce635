"""Twins served by the command line, and Modbus clients of other libraries.

Clients are alike: they return words, or an exception's code, or DONE, or SILENCE.
"""

import contextlib
import ctypes
import ctypes.util
import os
import re
import select
import signal
import socket
import subprocess
import sys

import pytest

from gonio.rig import load_rig

DONE, SILENCE = "done", "silence"
# for a unit that does not answer at all
TIMEOUT_S = 1.0


class PyModbusTcp:
    """PyPI pyModbusTCP."""

    def __init__(self, arm):
        from pyModbusTCP.client import ModbusClient

        self.client = ModbusClient(arm.host, arm.port, timeout=TIMEOUT_S, auto_open=True)

    def read(self, unit, address, count=1, function=3):
        self.client.unit_id = unit
        read = {3: self.client.read_holding_registers, 4: self.client.read_input_registers}
        return self._result(read[function](address, count))

    def write(self, unit, address, *words, single=False):
        self.client.unit_id = unit
        if single:
            return self._result(self.client.write_single_register(address, *words))
        return self._result(self.client.write_multiple_registers(address, list(words)))

    def close(self):
        self.client.close()

    def _result(self, answer):
        return DONE if answer is True else answer or self.client.last_except or SILENCE


class PyModbus:
    """PyPI pymodbus."""

    def __init__(self, arm):
        from pymodbus.client import ModbusSerialClient, ModbusTcpClient

        if arm.transport == "tcp":
            client = ModbusTcpClient(arm.host, port=arm.port, timeout=TIMEOUT_S, retries=0)
        else:
            client = ModbusSerialClient(arm.device, baudrate=115200, timeout=TIMEOUT_S, retries=0)
        self.client = client
        assert client.connect()

    def read(self, unit, address, count=1, function=3):
        read = {3: self.client.read_holding_registers, 4: self.client.read_input_registers}
        return self._result(lambda: read[function](address, count=count, device_id=unit))

    def write(self, unit, address, *words, single=False):
        if single:
            return self._result(lambda: self.client.write_register(address, *words, device_id=unit))
        return self._result(
            lambda: self.client.write_registers(address, list(words), device_id=unit)
        )

    def close(self):
        self.client.close()

    def _result(self, request):
        from pymodbus.exceptions import ModbusIOException

        try:
            answer = request()
        except ModbusIOException:
            return SILENCE
        if answer.isError():
            return answer.exception_code
        return answer.registers if answer.function_code in (3, 4) else DONE


class MinimalModbus:
    """PyPI minimalmodbus, for RTU."""

    def __init__(self, arm):
        import minimalmodbus

        self.errors = minimalmodbus
        self.client = minimalmodbus.Instrument(arm.device, 1)
        self.client.serial.baudrate = 115200
        self.client.serial.timeout = TIMEOUT_S

    def read(self, unit, address, count=1, function=3):
        return self._result(unit, self.client.read_registers, address, count, function)

    def write(self, unit, address, *words, single=False):
        if single:
            return self._result(unit, self.client.write_register, address, *words, 0, 6)
        return self._result(unit, self.client.write_registers, address, list(words))

    def close(self):
        self.client.serial.close()

    def _result(self, unit, request, *arguments):
        self.client.address = unit
        try:
            return request(*arguments) or DONE
        except self.errors.NoResponseError:
            return SILENCE
        except self.errors.SlaveReportedException as error:
            texts = {"function": 1, "address": 2, "value": 3}
            return texts[re.search("illegal (?:data )?(function|address|value)", str(error))[1]]


class LibModbus:
    """Debian's libmodbus5, in C."""

    def __init__(self, arm):
        name = ctypes.util.find_library("modbus") or pytest.skip("needs libmodbus5")
        self.library = library = ctypes.CDLL(name, use_errno=True)
        for function in ("modbus_new_tcp", "modbus_new_rtu"):
            getattr(library, function).restype = ctypes.c_void_p
        if arm.transport == "tcp":
            context = library.modbus_new_tcp(arm.host.encode(), arm.port)
        else:
            parity = ctypes.c_char(b"N")
            context = library.modbus_new_rtu(arm.device.encode(), 115200, parity, 8, 1)
        self.context = ctypes.c_void_p(context)
        library.modbus_set_response_timeout(self.context, 0, round(1e6 * TIMEOUT_S))
        assert library.modbus_connect(self.context) == 0

    def read(self, unit, address, count=1, function=3):
        words = (ctypes.c_uint16 * count)()
        name = {3: "modbus_read_registers", 4: "modbus_read_input_registers"}[function]
        return self._result(unit, name, address, count, words) or list(words)

    def write(self, unit, address, *words, single=False):
        if single:
            return self._result(unit, "modbus_write_register", address, *words) or DONE
        values = (ctypes.c_uint16 * len(words))(*words)
        name = "modbus_write_registers"
        return self._result(unit, name, address, len(words), values) or DONE

    def close(self):
        self.library.modbus_close(self.context)
        self.library.modbus_free(self.context)

    def _result(self, unit, name, *arguments):
        """Return None when it went well."""
        self.library.modbus_set_slave(self.context, unit)
        if getattr(self.library, name)(self.context, *arguments) >= 0:
            return None
        code = ctypes.get_errno() - 112345678
        return code if code > 0 else SILENCE


CLIENTS = {
    "tcp-pyModbusTCP": PyModbusTcp,
    "tcp-pymodbus": PyModbus,
    "tcp-libmodbus": LibModbus,
    "rtu-pymodbus": PyModbus,
    "rtu-minimalmodbus": MinimalModbus,
    "rtu-libmodbus": LibModbus,
}


class Served:
    """`gonio sim serve` in a process of its own, up to its end."""

    def __init__(self, folder, *options, stderr=subprocess.PIPE):
        self.folder = folder
        self.process = subprocess.Popen(
            [sys.executable, "-m", "gonio", "sim", "serve", "--folder", str(folder), *options],
            stdout=subprocess.PIPE,
            stderr=stderr,
            # so that select sees each line that was not read
            bufsize=0,
            env=os.environ | {"OMP_NUM_THREADS": "1"},
        )
        self.said = self._line()
        self.next = self._line()

    def _line(self):
        assert select.select([self.process.stdout], [], [], 60)[0], "serve says nothing"
        line = self.process.stdout.readline().decode()
        return line or pytest.fail(f"serve ended: {self.process.communicate()[1].decode()}")

    @property
    def rig(self):
        return load_rig(self.folder / "rig.toml")

    def end(self, number=signal.SIGINT):
        """Send a signal; return exit code, and what it says."""
        self.process.send_signal(number)
        out, err = self.process.communicate(timeout=20)
        return self.process.returncode, out.decode(), (err or b"").decode()

    def close(self):
        if self.process.poll() is None:
            self.end(signal.SIGKILL)
        for stream in filter(None, (self.process.stdout, self.process.stderr)):
            stream.close()


@pytest.fixture
def serve(tmp_path):
    """Serve a twin from a folder of this test: serve("--rtu")."""
    with contextlib.ExitStack() as stack:

        def start(*options, **streams):
            served = Served(tmp_path / "served", *options, **streams)
            return stack.enter_context(contextlib.closing(served))

        yield start


@pytest.fixture(scope="session")
def tcp(tmp_path_factory):
    """A twin at Modbus TCP, for tests that leave it as it was."""
    with contextlib.closing(Served(tmp_path_factory.mktemp("tcp") / "served")) as served:
        yield served


@pytest.fixture(scope="session")
def rtu(tmp_path_factory):
    """A twin at Modbus RTU, for tests that leave it as it was."""
    with contextlib.closing(Served(tmp_path_factory.mktemp("rtu") / "served", "--rtu")) as served:
        yield served


@pytest.fixture(params=CLIENTS)
def client(request):
    """Each client at a twin; `client.wire` is tcp or rtu."""
    wire = request.param.partition("-")[0]
    with contextlib.closing(CLIENTS[request.param](request.getfixturevalue(wire).rig.arm)) as made:
        made.wire = wire
        yield made


@pytest.fixture
def connect():
    """Connect a client to a twin at TCP: connect(served)."""
    with contextlib.ExitStack() as stack:
        yield lambda served: stack.enter_context(contextlib.closing(PyModbusTcp(served.rig.arm)))


@pytest.fixture
def arrived():
    """Wait until a twin has taken in what was sent to it before: arrived(served)."""

    def wait(served):
        with socket.socket(socket.AF_UNIX) as control:
            control.connect(os.path.realpath(served.folder / "control"))
            control.sendall(b"place sample")
            assert control.recv(100) == b"done"

    return wait
