"""A twin and its wires on one event loop: one thing at a time, so that nothing needs a lock."""

from __future__ import annotations

import asyncio
import contextlib
import signal
from functools import partial
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from gonio.clock import VirtualClock
from gonio.errors import BadInputError, GonioError
from sim.faults import faulty_ends
from sim.faults.files import FaultyFiles
from sim.served import control
from sim.served.camera import DarkRoom, ServedCamera
from sim.served.faulty_arm import RTU, TCP, FaultyArm
from sim.served.faulty_lamps import FaultyLamps
from sim.served.lamp_port import LampPort
from sim.served.modbus import ModbusUnits
from sim.served.present import Present, WireClock
from sim.served.pty import PseudoTerminal
from sim.served.rtu import RtuLine
from sim.served.tcp import TcpClient
from sim.twin import Twin

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Iterator, Sequence

    from gonio.rig import Rig
    from sim.faults import Fault
    from sim.imperfections import Imperfections
    from sim.served.folder import ServedFolder
    from sim.tether import Camera

HOST = "127.0.0.1"

_TICK_S = 0.005

P = ParamSpec("P")
R = TypeVar("R")


class Server:
    """A twin to be served from a folder.

    Parameters
    ----------
    rig
        What it is a twin of; its transport says whether the arm is on TCP or RTU.
    camera
        Makes the files.
    folder
        Where everything is offered.
    seed
        As for `sim.twin.Twin`.
    power_ups
        How often a twin was started here before.
    speed
        How many times faster than real time it runs.
    warn
        Takes a line about a frame that could not be written.
    imperfections
        Of the twin's arms.
    faults
        What may go wrong.

    Attributes
    ----------
    twin, camera
        What is served, to be looked at.
    struck
        How often each kind of fault has struck.
    """

    def __init__(
        self,
        rig: Rig,
        camera: Camera,
        folder: ServedFolder,
        seed: int,
        power_ups: int,
        speed: float,
        warn: Callable[[str], None],
        imperfections: Imperfections,
        faults: Sequence[Fault] = (),
    ) -> None:
        self._rig, self._folder, self._warn = rig, folder, warn
        self._clock = clock = VirtualClock()
        self.camera = ServedCamera(camera, power_ups)
        self.twin = Twin(
            rig, self.camera, clock, folder.frames, seed, wires=WireClock(clock),
            imperfections=imperfections,
        )  # fmt: skip
        self.twin.hurry(speed)
        is_tcp = rig.arm.transport == "tcp"
        self._ends = ends = faulty_ends(self.twin, rig, clock, faults, seed)
        self.struck = ends.injector.struck
        self.twin.tether.write = FaultyFiles(clock, ends.injector).write
        units = ModbusUnits(ends.bus, self.twin.bus.has, answers_for_unknown=is_tcp)
        self._arm = FaultyArm(units.answer, ends.axes, ends.injector, TCP if is_tcp else RTU)
        self._present = Present(clock, speed)
        self._acts = control.acts(self.twin)

    async def run(
        self, port: int | None, ready: Callable[[int | None], None], tick: Callable[[float], None]
    ) -> None:
        """Serve until Ctrl-C or SIGTERM.

        Parameters
        ----------
        port
            Of TCP; None or 0: a free one.
        ready
            Called when everything is open, with the port; None for RTU.
        tick
            Called every few milliseconds with the twin's time.

        Raises
        ------
        gonio.errors.BadInputError
            When the port cannot be opened.
        """
        loop = asyncio.get_running_loop()
        stop: asyncio.Future[None] = loop.create_future()
        loop.set_exception_handler(lambda _, context: self._failed(context, stop))
        for number in (signal.SIGINT, signal.SIGTERM):
            loop.add_signal_handler(number, _finish, stop)
        async with contextlib.AsyncExitStack() as opened:
            opened.enter_context(self._lamps())
            room = opened.enter_context(contextlib.closing(DarkRoom()))
            self.twin.tether.develop = room.develop
            if self._rig.arm.transport == "tcp":
                found: int | None = await opened.enter_async_context(self._tcp(port or 0))
            else:
                found = opened.enter_context(self._rtu())
            await opened.enter_async_context(control.listening(self._folder.control, self._do))
            ready(found)
            while not stop.done():
                self._present.catch_up()
                tick(self._clock.now())
                await asyncio.wait([stop], timeout=_TICK_S)
            stop.result()

    @contextlib.contextmanager
    def _lamps(self) -> Iterator[None]:
        with contextlib.closing(PseudoTerminal(self._folder.lamps)) as terminal:
            wire = FaultyLamps(self._ends.line, self._ends.injector, terminal.send, terminal.unplug)
            lamps = LampPort(wire, wire.answer)
            terminal.listen(self._now(lamps.receive))
            yield

    @contextlib.contextmanager
    def _rtu(self) -> Iterator[None]:
        with contextlib.closing(PseudoTerminal(self._folder.arm)) as terminal:
            arm = RtuLine(self._now(self._arm.answer), partial(self._arm.send, terminal.send))
            terminal.listen(arm.receive)
            yield

    @contextlib.asynccontextmanager
    async def _tcp(self, port: int) -> AsyncIterator[int]:
        answer = self._now(self._arm.answer)
        try:
            server = await asyncio.get_running_loop().create_server(
                lambda: TcpClient(answer, self._arm.send), HOST, port
            )
        except OSError as error:
            raise BadInputError(
                f"port {port}: cannot be opened ({error.strerror}); choose another with --port, "
                "or leave it out for a free one"
            ) from None
        try:
            yield server.sockets[0].getsockname()[1]
        finally:
            server.close()

    def _do(self, words: str) -> None:
        self._now(self._acts[words])()

    def _now(self, act: Callable[P, R]) -> Callable[P, R]:
        """Return what brings the twin up to the present before it acts."""

        def act_now(*args: P.args, **kwargs: P.kwargs) -> R:
            self._present.catch_up()
            return act(*args, **kwargs)

        return act_now

    def _failed(self, context: dict[str, Any], stop: asyncio.Future[None]) -> None:
        """Warn of what a person can mend; let a defect end the server, where it is seen."""
        error = context.get("exception")
        if isinstance(error, GonioError):
            self._warn(str(error))
        elif error is not None and not stop.done():
            stop.set_exception(error)


def _finish(stop: asyncio.Future[None]) -> None:
    if not stop.done():
        stop.set_result(None)
