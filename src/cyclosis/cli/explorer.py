"""The command for the explorer."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import UNITS


def explore(
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Address to listen on; by default this machine only.")
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(metavar="WHOLE", min=0, max=65535, help="Port to listen on; 0: any free one.")
    ] = 8765,
    name: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Name under which the server answers, besides its host; may be repeated; * for any.",
        ),
    ] = None,
    sessions: Annotated[
        int, typer.Option(metavar="WHOLE", min=1, max=1000, help="Most visitors at once.")
    ] = 8,
    idle_minutes: Annotated[
        float,
        typer.Option(metavar="MINUTES", min=0.1, max=525_600, help="Minutes for which a cell may be idle."),
    ] = 30.0,
    static: Annotated[
        str | None,
        typer.Option(metavar="DIR", help="Write the page as files for any web server, and end."),
    ] = None,
    radius_um: Annotated[
        float | None,
        typer.Option(
            metavar="NUMBER",
            help="Radius of cells in micrometres, to show them in units; with --speed-um-s.",
            rich_help_panel=UNITS,
        ),
    ] = None,
    speed_um_s: Annotated[
        float | None,
        typer.Option(
            metavar="NUMBER", help="Their speed U in micrometres per second.", rich_help_panel=UNITS
        ),
    ] = None,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page.")] = True,
    ahead: Annotated[
        bool,
        typer.Option("--ahead/--no-ahead", help="Compile what the presets need while nothing is computed."),
    ] = True,
) -> None:
    """Open the explorer: a living cell in the browser."""
    import webbrowser

    from ..config import check
    from ..explorer.server import LOOPBACK, ServerLimits, serve
    from ..model.devices import require_devices
    from ..model.units import of_table

    require_devices()
    given = {"radius_um": radius_um, "speed_um_s": speed_um_s}
    scales = check({"scales": {name: value for name, value in given.items() if value is not None}})["scales"]
    of_table(scales)  # both or neither
    if static is not None:
        from ..explorer.static import write

        size = write(static, scales=scales or None)
        print(f"{static}: {size / 1e6:.1f} MB for any web server; the page needs no Python", flush=True)
        print(f"try it: python -m http.server --directory {static}, then http://localhost:8000", flush=True)
        return

    def ready(port: int) -> None:
        address = f"http://{f'[{host}]' if ':' in host else host}:{port}/"
        print(f"the explorer is at {address} (Ctrl-C ends it)", flush=True)
        if browser:
            webbrowser.open(address)

    hosts = tuple(each.lower() for each in (*LOOPBACK, host, *(name or ())))
    serve(host, port, ServerLimits(sessions, 60.0 * idle_minutes, hosts, ahead=ahead), ready, scales or None)
