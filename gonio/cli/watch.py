"""`gonio watch`: a live page of a capture."""

from __future__ import annotations

from pathlib import Path

import click


@click.command(name="watch")
@click.argument("session", type=click.Path(path_type=Path), default=Path("session"))
@click.option("--host", default="127.0.0.1", show_default=True, help="Where to listen.")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="The port.  [default: any free one]"
)
@click.option("--open", "opens", is_flag=True, help="Open the page in the browser.")
def command(*, session: Path, host: str, port: int, opens: bool) -> None:
    """Show how a capture goes, as a page in the browser, until Ctrl-C.

    It reads the session's journal from a process of its own, before, during and after the capture,
    and can pause and stop it. The address holds a token: who has it may do so.

    \b
    Examples:
        gonio watch
        gonio watch leather/ --open
        gonio watch --host 0.0.0.0 --port 8765
    """  # noqa: D301
    from contextlib import suppress

    from gonio.errors import BadInputError
    from gonio.session import Session
    from gonio.watch import WatchServer

    opened = Session.open(session)
    try:
        server = WatchServer(opened, host, port)
    except OSError as error:
        raise BadInputError(
            f"{host}:{port}: cannot listen there ({error.strerror}); give another --host or --port"
        ) from None
    with server, suppress(KeyboardInterrupt):
        click.echo(f"{session}: {server.access.url}   (Ctrl-C ends watching, not the capture)")
        if opens:
            click.launch(server.access.url)
        server.serve_forever()
