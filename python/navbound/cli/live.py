"""`navbound live`: judge data that are still arriving, read a journal again, compare two runs."""

from __future__ import annotations

import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from navbound.cli.parts import err_console, out_console
from navbound.errors import InputError
from navbound.exit_status import OUR_BUG

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound.live import Session, Settings


class SourceFirst(TyperGroup):
    """`navbound live SOURCE` is `navbound live watch SOURCE`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the name of the command before what is none."""
        named = not args or args[0] in self.commands or args[0] == "--help"
        return super().parse_args(ctx, args if named else ["watch", *args])


app = typer.Typer(cls=SourceFirst, help="Judge data that are still arriving: navbound live SOURCE ...", no_args_is_help=True)
JsonLines = Annotated[bool, typer.Option("--json", help="Print one JSON object a transition, nothing else.")]
SessionOut = Annotated[Path, typer.Option("--out", help="Folder of the session: journal in and out, events, tables.")]
Journal = Annotated[Path, typer.Argument(help="Folder of a session, or its journal in (in.nvj).")]


@app.command()
def watch(
    source: Annotated[str, typer.Argument(help="A file, a run directory, - (standard input), tcp://host:port or udp://host:port.")],
    out: SessionOut = Path("out/live"),
    spec: Annotated[str, typer.Option(help="Navigation specification, such as 'RNP 0.3'.")] = "RNP 0.3",
    path: Annotated[str | None, typer.Option(help="Where the aircraft should be: a runway (LFPG/08R) or a route file.")] = None,
    form: Annotated[str | None, typer.Option("--format", help="json, ubx, sbf, novatel or nmea. [default: by a file's begin]")] = None,
    method: Annotated[
        str, typer.Option(help="tse-exact or anp-circle. [default: the first with --path or a run that has one, otherwise the second]")
    ] = "",
    track: Annotated[str, typer.Option(help="Name of a receiver's track.")] = "receiver",
    period_s: Annotated[float, typer.Option(help="Sample period of a track.")] = 1.0,
    time_to_alert_s: Annotated[float, typer.Option(help="Time to alert; a chain of times that is longer is refused.")] = 10.0,
    raise_delay_s: Annotated[float, typer.Option(help="How long the accuracy bound is outside before the caution.")] = 3.0,
    lateness_s: Annotated[float, typer.Option(help="How long the order of a track is waited for; 1 for a fleet.")] = 0.0,
    expiry_s: Annotated[float | None, typer.Option(help="Silence after which a track is forgotten. [default: never]")] = None,
    speed: Annotated[float, typer.Option(help="Of a file: times its own pace; 0 as fast as it goes.")] = 0.0,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the session in --out.")] = False,
    json: JsonLines = False,
) -> None:
    """Judge a source until it ends or the command is stopped; alerts are reported as they are raised.

    A file keeps no time of arrival, so no latency is claimed for it. A connection that is lost later is an event and is opened again.
    """
    from navbound import live  # noqa: PLC0415
    from navbound.live.recording import has_path  # noqa: PLC0415
    from navbound.live.source import CHUNK, format_of  # noqa: PLC0415
    from navbound.rnp.requirement import requirement  # noqa: PLC0415

    known = form or (None if "://" in source or source == "-" else format_of(source))
    if known is None and ("://" in source or source == "-"):
        raise InputError("format", "none", domain="json, ubx, sbf, novatel or nmea with --format: a stream is not guessed")
    settings = live.Settings(
        format=known or "json",
        rnp_m=requirement(spec).rnp_m,
        path=path,
        method=method or ("tse-exact" if has_path(Path(source)) else ""),
        track=track,
        sample_period_s=period_s,
        time_to_alert_s=time_to_alert_s,
        raise_delay_s=raise_delay_s,
        lateness_s=lateness_s,
        expiry_s=expiry_s,
    )
    settings.core()
    if not 0 <= speed < float("inf"):
        raise InputError("speed", speed, "1", "[0, inf)")
    opened = live.open_source(source, lines=settings.format == "json", chunk=512 if speed else CHUNK)
    stop = _stop()
    session = live.Session(out, settings, resume=resume, report=_report(json=json), say=_say)
    try:
        session.run(opened, stop=stop, speed=speed)
    finally:
        opened.close()
    _ended(session, settings, json=json)


@app.command()
def replay(
    journal: Journal,
    out: SessionOut = Path("out/replay"),
    speed: Annotated[float, typer.Option(help="Times the pace of the data; 0 as fast as it goes.")] = 1.0,
    group: Annotated[int, typer.Option(help="Inputs that are judged at once.")] = 1,
    json: JsonLines = False,
) -> None:
    """Read a journal again, at any speed: the same bounds and alerts in every bit."""
    from navbound import live  # noqa: PLC0415
    from navbound.live.replay import settings_of  # noqa: PLC0415

    if not 0 <= speed < float("inf"):
        raise InputError("speed", speed, "1", "[0, inf)")
    if group < 1:
        raise InputError("group", group, "1", "[1, inf)")
    session = live.replay(journal, out, speed=speed, group=group, report=_report(json=json), stop=_stop(), say=_say)
    _ended(session, settings_of(journal), json=json)


@app.command()
def judge(journal: Journal, out: SessionOut = Path("out/judged"), json: JsonLines = False) -> None:
    """Judge a whole journal at once: the causal batch."""
    from navbound import live  # noqa: PLC0415
    from navbound.live.replay import settings_of  # noqa: PLC0415

    _ended(live.judge(journal, out, say=_say), settings_of(journal), json=json)


@app.command()
def compare(a: Annotated[Path, typer.Argument(help="Folder of a session.")], b: Annotated[Path, typer.Argument(help="Another.")]) -> None:
    """Compare every bound, status, alert and transition of two sessions as bits; exit status 70 where one differs."""
    from navbound import live  # noqa: PLC0415

    result = live.compare(a, b)
    where = "" if result.first is None else f", the first at {result.first}"
    out_console.print(
        f"{result.n_epochs} epochs and {result.n_transitions} transitions compared: {result.n_differing} differ{where}.", highlight=False
    )
    if result.n_differing:
        raise typer.Exit(OUR_BUG)


def _stop() -> Callable[[], bool]:
    """Whether an end was requested; requested twice, the command ends at once."""
    requested = list[int]()

    def ask(number: int, _: object) -> None:
        if requested:
            raise KeyboardInterrupt
        requested.append(number)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, ask)
    return lambda: bool(requested)


def _say(sentence: str) -> None:
    err_console.print(f"navbound live: {sentence}", markup=False, highlight=False, soft_wrap=True)


def _report(*, json: bool) -> Callable[[dict[str, Any]], None]:
    from navbound.live import transition  # noqa: PLC0415
    from navbound.time import utc_text  # noqa: PLC0415

    def report(reported: dict[str, Any]) -> None:
        if json:
            sys.stdout.write(transition.line(reported) + "\n")
            sys.stdout.flush()
        else:
            out_console.print(transition.words(reported, utc_text(reported["event_ns"])), markup=False, highlight=False, soft_wrap=True)

    return report


def _ended(session: Session, settings: Settings, *, json: bool) -> None:
    from navbound.live import tables  # noqa: PLC0415

    counters = session.counters()
    if session.n_epochs:
        tables.write(session.folder, time_to_alert_s=settings.time_to_alert_s)
    refused = ", ".join(f"{n} {name.removeprefix('refused_')}" for name, n in counters.items() if name.startswith("refused_") and n)
    sentence = (
        f"{session.n_epochs} epochs of {session.n_tracks} tracks, {session.n_transitions} transitions; "
        f"refused: {refused or 'nothing'}; session in {session.folder}"
    )
    if json:
        _say(sentence)
    else:
        out_console.print(sentence, markup=False, highlight=False, soft_wrap=True)
