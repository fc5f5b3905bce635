"""`gonio sim serve`: the twin over real wires."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gonio.cli._imperfections import imperfections_option
from gonio.cli._numbers import FiniteRange
from gonio.cli._served import DEFAULT_FOLDER

if TYPE_CHECKING:
    from gonio.rig import Rig
    from sim.served.folder import ServedFolder
    from sim.served.server import Server


@click.command(name="serve")
@click.option(
    "--rig", "rig_path", type=click.Path(path_type=Path), help="A rig file.  [default: built in]"
)
@click.option(
    "--material",
    default="wood-veneer",
    show_default=True,
    metavar="NAME|FILE",
    help="What the twin carries: a name from `gonio materials`, or a file, as of capture --sim.",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of all noise."
)
@imperfections_option
@click.option("--rtu", is_flag=True, help="Modbus RTU at a pseudo-terminal instead of TCP.")
@click.option(
    "--port",
    type=click.IntRange(1, 65535),
    help="Of Modbus TCP, at 127.0.0.1.  [default: as the last time, else a free one]",
)
@click.option(
    "--folder",
    type=click.Path(path_type=Path),
    default=DEFAULT_FOLDER,
    show_default=True,
    help="Where rig file, ports and frames appear.",
)
@click.option(
    "--faults",
    "faults_path",
    type=click.Path(path_type=Path),
    help="A file of what goes wrong and when (docs/topics/faults.md).",
)
@click.option(
    "--speed",
    type=FiniteRange(1, 100),
    default=1.0,
    show_default=True,
    metavar="X",
    help="How many times faster than real time the twin moves, warms up and exposes.",
)
def command(
    *,
    rig_path: Path | None,
    material: str,
    seed: int,
    imperfections: str | None,
    rtu: bool,
    port: int | None,
    folder: Path,
    faults_path: Path | None,
    speed: float,
) -> None:
    """Offer the simulated rig as hardware would be there, until Ctrl-C.

    Modbus TCP at a port, or Modbus RTU at a pseudo-terminal; the lamps' line at another one;
    frames in a folder. It writes the rig file by which to use it. What the twin carries is known
    to nobody who captures: truth.npz beside the rig file holds it, to compare with.

    \b
    Examples:
        gonio sim serve
        gonio sim serve --rtu --material satin
        gonio sim serve --speed 10 --folder fast/
        gonio sim serve --faults faults.toml
    """  # noqa: D301
    from gonio.errors import BadInputError
    from gonio.rig import default_rig, load_rig
    from sim.camera import SimCamera
    from sim.faults import load_faults
    from sim.imperfections import load_imperfections
    from sim.materials import load_material
    from sim.served.folder import ServedFolder
    from sim.served.server import Server
    from sim.truth import write_truth

    rig = load_rig(rig_path) if rig_path else default_rig()
    if rtu:
        rig = rig.model_copy(update={"arm": rig.arm.model_copy(update={"transport": "rtu"})})
    if port and rig.arm.transport == "rtu":
        raise BadInputError("--port is of Modbus TCP, and this rig is on RTU; leave one out")
    name = material if Path(material).suffix else material.lower()
    carried, wanted = load_material(name), load_imperfections(imperfections or "none")
    faults = load_faults(faults_path) if faults_path else ()
    served = ServedFolder(folder)
    with served.held():
        camera = SimCamera(rig, carried, seed, wanted.of_camera)
        server = Server(
            rig, camera, served, seed, served.start(name, seed), speed, _warn, wanted, faults
        )
        write_truth(served.truth_path, carried)
        _run(server, served, rig, folder, port or served.last_port())


def _run(server: Server, served: ServedFolder, rig: Rig, folder: Path, port: int | None) -> None:
    from gonio.cli._twin_status import status_line
    from gonio.words import several

    def ready(port: int | None) -> None:
        served.write_rig(rig, port)
        arm = f"Modbus TCP at 127.0.0.1:{port}" if port else f"Modbus RTU at {folder / 'arm'}"
        click.echo(f"{arm}, lamps at {folder / 'lamps'}, frames in {folder / 'frames'}")
        click.echo(f"next: gonio capture --rig {folder / 'rig.toml'}   (Ctrl-C here ends the twin)")

    with status_line(server) as tick:
        asyncio.run(server.run(port, ready, tick))
    click.echo(f"{folder}: the twin is gone, after {several(server.camera.frames, 'frame')}")
    if server.struck:
        struck = (f"{times} x {kind}" for kind, times in server.struck.items())
        click.echo(f"faults that struck: {', '.join(struck)}")


def _warn(message: str) -> None:
    click.echo(f"gonio: {message}", err=True)
