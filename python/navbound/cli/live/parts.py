"""What the commands of `navbound live` have in common."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navbound.cli.parts import err_console, out_console

if TYPE_CHECKING:
    from collections.abc import Callable

JsonLines = Annotated[bool, typer.Option("--json", help="Print one JSON object a transition, nothing else.")]
Spec = Annotated[str, typer.Option(help="Navigation specification, such as 'RNP 0.3'.")]
ShowDisplay = Annotated[
    bool, typer.Option("--display", help="Show it in a browser on this host: the address is printed. Ctrl-C ends both.")
]
OpenPage = Annotated[bool, typer.Option("--open", help="Show it, and open the page in the browser of this machine.")]
DisplayPort = Annotated[int, typer.Option(help="Port of the display. [default: one that is free]", show_default=False)]


def say(sentence: str) -> None:
    """A sentence about the session itself, on standard error."""
    err_console.print(f"navbound live: {sentence}", markup=False, highlight=False, soft_wrap=True)


def report_to(*, json: bool) -> Callable[[dict[str, Any]], None]:
    """What prints a transition on standard output."""
    from navbound.live.sinks import transition  # noqa: PLC0415
    from navbound.time import utc_text  # noqa: PLC0415

    def report(reported: dict[str, Any]) -> None:
        if json:
            sys.stdout.write(transition.line(reported) + "\n")
            sys.stdout.flush()
        else:
            out_console.print(
                transition.words(reported, utc_text(transition.turned_ns(reported))), markup=False, highlight=False, soft_wrap=True
            )

    return report


def address(text: str, *, json: bool) -> None:
    """Where the display is."""
    if json:
        say(f"display: {text}")
    else:
        out_console.print(f"Display: {text}", markup=False, highlight=False, soft_wrap=True)
