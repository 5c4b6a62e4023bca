"""`navbound live`: judge data that are still arriving, read a journal again, compare two runs."""

from __future__ import annotations

import time
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from navbound.cli.live import fleet
from navbound.cli.live.ended import ended
from navbound.cli.live.parts import DisplayPort, JsonLines, OpenPage, ShowDisplay, Spec, address, report_to, say
from navbound.cli.parts import out_console, stop_requested
from navbound.delays import RAISE_DELAY_S, TIME_TO_ALERT_S
from navbound.errors import ConflictError, FormatError, InputError
from navbound.exit_status import NO_VERDICT, OUR_BUG
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound.live import Session, Settings
    from navbound.live.child import Child
    from navbound.live.sinks.webhook import Target


class SourceFirst(TyperGroup):
    """`navbound live SOURCE` is `navbound live watch SOURCE`."""

    unnamed = "watch"

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the name of the command before what is none."""
        named = not args or args[0] in self.commands or args[0] == "--help"
        return super().parse_args(ctx, args if named else [self.unnamed, *args])


app = typer.Typer(cls=SourceFirst, help="Judge data that are still arriving: navbound live SOURCE ...", no_args_is_help=True)
fleet.register(app)
SessionOut = Annotated[Path, typer.Option("--out", help="Folder of the session: journal in and out, events, tables.")]
Journal = Annotated[Path, typer.Argument(help="Folder of a session, or its journal in (in.nvj).")]
Course = Annotated[str | None, typer.Option(help="Where the aircraft should be: a runway (LFPG/08R) or a route file.")]
Form = Annotated[
    str | None, typer.Option("--format", help="json, readsb, beast, avr, ubx, sbf, novatel or nmea. [default: by a file's begin]")
]
Level = Annotated[str | None, typer.Option(help="Service level whose alert limits the display shows, such as LPV-200.")]
Hook = Annotated[
    str | None, typer.Option("--webhook", help="Address that each transition is sent to: https://..., or http:// on this host.")
]
Sigma = Annotated[
    float | None, typer.Option(help="Stated standard deviation of the position per axis, where the source states no larger accuracy.")
]
SecretFile = Annotated[Path | None, typer.Option("--secret-file", help="File with the key of the signature of what is sent to --webhook.")]


@app.command()
def watch(
    source: Annotated[
        str,
        typer.Argument(
            help="A file, a run directory, - (standard input), tcp://host:port, udp://host:port or serial:///dev/ttyACM0?baud=115200."
        ),
    ],
    out: SessionOut = Path("out/live"),
    spec: Spec = "RNP 0.3",
    path: Course = None,
    form: Form = None,
    method: Annotated[
        str, typer.Option(help="tse-exact or anp-circle. [default: the first with --path or a track that states fte_m]")
    ] = "",
    track: Annotated[str, typer.Option(help="Name of a receiver's track.")] = "receiver",
    sigma_m: Sigma = None,
    period_s: Annotated[float, typer.Option(help="Sample period of a track.")] = 1.0,
    time_to_alert_s: Annotated[float, typer.Option(help="Time to alert; a chain of times that is longer is refused.")] = TIME_TO_ALERT_S,
    raise_delay_s: Annotated[float, typer.Option(help="How long the accuracy bound is outside before the caution.")] = RAISE_DELAY_S,
    lateness_s: Annotated[float, typer.Option(help="How long the order of a track is waited for; 1 for a fleet.")] = 0.0,
    expiry_s: Annotated[float | None, typer.Option(help="Silence after which a track is forgotten. [default: never]")] = None,
    standing: Annotated[bool, typer.Option("--standing", help="The receiver stands: a position that repeats is not held.")] = False,
    speed: Annotated[float, typer.Option(help="Of a file: times its own pace, 0 or more; 0 is as fast as it goes.")] = 0.0,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the session in --out.")] = False,
    display: ShowDisplay = False,
    port: DisplayPort = 0,
    open_page: OpenPage = False,
    level: Level = None,
    webhook: Hook = None,
    secret_file: SecretFile = None,
    json: JsonLines = False,
) -> None:
    """Judge a source until it ends or the command is stopped; alerts are reported as they are raised.

    A file keeps no time of arrival, so no latency is claimed for it. A connection that is lost later is an event and is opened again.
    """
    settings = _settings(
        source,
        form,
        spec=spec,
        path=path,
        method=method,
        track=track,
        sigma_m=sigma_m,
        sample_period_s=period_s,
        time_to_alert_s=time_to_alert_s,
        raise_delay_s=raise_delay_s,
        lateness_s=lateness_s,
        expiry_s=expiry_s,
        standing=standing,
    )
    _run(
        source,
        settings,
        _Ways(
            out,
            speed,
            _Screen(port if display or open_page else None, json=json, opened=open_page),
            limits=_limits(level),
            resume=resume,
            json=json,
            target=_target(webhook, secret_file),
        ),
    )


@dataclass(frozen=True)
class _Ways:
    """Where a session goes and who sees it."""

    out: Path
    speed: float
    screen: _Screen
    limits: dict[str, Any] | None = None
    resume: bool = False
    json: bool = False
    replay: bool = False
    target: Target | None = None


def _settings(source: str, form: str | None, *, spec: str, path: str | None, method: str = "", **others: Any) -> Settings:
    """What a session of a source is set to, checked."""
    from navbound import live  # noqa: PLC0415
    from navbound.live.recording import has_path  # noqa: PLC0415
    from navbound.live.settings import FORMATS  # noqa: PLC0415
    from navbound.live.source import format_of, is_stream  # noqa: PLC0415
    from navbound.rnp.requirement import requirement  # noqa: PLC0415

    known = form or (None if is_stream(source) else format_of(source))
    if known is None and is_stream(source):
        raise InputError("format", "none", domain=f"{', '.join(FORMATS)} with --format: a stream is not guessed")
    selected = method or ("tse-exact" if has_path(Path(source)) else "")
    if Path(source).is_dir():
        # The motion of a finished run was judged with what it knew, a receiver that stands among it.
        others["standing"] = True
    settings = live.Settings(format=known or "json", rnp_m=requirement(spec).rnp_m, path=path, method=selected, **others)
    settings.core()
    return settings


def _run(source: str, settings: Settings, ways: _Ways) -> None:
    """Judge a source until it ends or the command is stopped."""
    from navbound import live  # noqa: PLC0415
    from navbound.live.course import points  # noqa: PLC0415
    from navbound.live.settings import LINES, UNDATED  # noqa: PLC0415
    from navbound.live.source import CHUNK  # noqa: PLC0415

    _check_speed(ways.speed)
    lines, undated = settings.format in LINES, settings.format in UNDATED
    opened = live.open_source(source, lines=lines, undated=undated, chunk=512 if ways.speed else CHUNK)
    if settings.assumed:
        say(settings.assumed)
    stop = stop_requested()
    kind: Any = "live" if opened.live else "replay" if ways.replay else "recording"
    origin = live.Origin(kind, source, None if opened.live else ways.speed, points(settings, source), ways.limits)
    session = live.Session(ways.out, settings, origin=origin, resume=ways.resume, report=report_to(json=ways.json), say=say)
    with ways.screen as screen, _Post(ways.target) as post:
        screen.show(session)
        post.begin(session)
        try:
            session.run(opened, stop=lambda: post.heard() or stop(), speed=ways.speed)
        finally:
            opened.close()
        ended(session, settings, json=ways.json)
        post.hold(stop)
        screen.hold(stop)


def _limits(name: str | None) -> dict[str, Any] | None:
    from navbound.kpi import level  # noqa: PLC0415

    if name is None:
        return None
    known = level(name)
    return {"name": known.id, "hal_m": known.hal_m, "val_m": known.val_m}


def _check_speed(speed: float) -> None:
    if not 0 <= speed < float("inf"):
        raise InputError("speed", speed, "1", "[0, inf)")


class _Screen:
    """The display beside a session, or none."""

    def __init__(self, port: int | None, *, json: bool, opened: bool) -> None:
        from navbound.live.display import Options  # noqa: PLC0415

        self._options = None if port is None else Options(port)
        self._json, self._opened = json, opened
        self._child: Child | None = None

    def __enter__(self) -> _Screen:
        return self

    def __exit__(self, *_: object) -> None:
        if self._child is not None:
            self._child.end()

    def show(self, session: Session) -> None:
        """Open it."""
        from navbound.live.display import child  # noqa: PLC0415

        if self._options is None:
            return
        self._child = child(session.folder, self._options)
        address(self._child.text, json=self._json)
        if self._opened and not webbrowser.open(self._child.text):
            say("no browser was found on this machine: open the address in one")

    def hold(self, stop: Callable[[], bool]) -> None:
        """Leave it open behind the end of the data, until the command is stopped."""
        if self._child is not None and not stop():
            say("the data have ended; the display stays open until Ctrl-C")
            while not stop():
                time.sleep(0.1)


def _target(url: str | None, secret_file: Path | None) -> Target | None:
    from navbound.live.sinks.webhook import Target, secret_of  # noqa: PLC0415

    if url is None:
        if secret_file is not None:
            raise ConflictError("secret_file", needs=("webhook",))
        return None
    return Target(url, None if secret_file is None else secret_of(secret_file))


class _Post:
    """What sends the transitions of a session on, in a process beside it, or nothing."""

    def __init__(self, target: Target | None) -> None:
        self._target = target
        self._child: Child | None = None

    def __enter__(self) -> _Post:
        return self

    def __exit__(self, *_: object) -> None:
        if self._child is not None:
            self._child.end()

    def begin(self, session: Session) -> None:
        """Start it."""
        from navbound.live.child import Child  # noqa: PLC0415
        from navbound.live.sinks.webhook import beside  # noqa: PLC0415

        if self._target is not None:
            self._child = Child(beside, session.folder, self._target, "transitions cannot be sent")

    def heard(self) -> bool:
        """Report what it said; never a reason to stop: who sends may fail, the monitor goes on."""
        for sentence in self._child.sentences() if self._child is not None else []:
            say(sentence)
        return False

    def hold(self, stop: Callable[[], bool]) -> None:
        """Wait behind the end of the data until everything was taken, or the command is stopped."""
        if self._child is None:
            return
        while self._child.works and not stop():
            self.heard()
            time.sleep(0.1)
        self.heard()
        if self._child.works:
            say("not every transition was taken; navbound live send goes on with them")


@app.command()
def replay(
    recording: Annotated[Path, typer.Argument(help="Folder of a session or its journal in (in.nvj); a run directory; a log.")],
    out: SessionOut = Path("out/replay"),
    speed: Annotated[float, typer.Option(help="Times the pace of the data, 0 or more; 0 is as fast as it goes.")] = 1.0,
    group: Annotated[int, typer.Option(help="Inputs of a journal that are judged at once.")] = 1,
    spec: Annotated[str | None, typer.Option(help="Of a run or a log: as of `navbound live`. [default: RNP 0.3]")] = None,
    path: Course = None,
    form: Form = None,
    sigma_m: Sigma = None,
    display: ShowDisplay = False,
    port: DisplayPort = 0,
    open_page: OpenPage = False,
    level: Level = None,
    json: JsonLines = False,
) -> None:
    """Read a journal again, at any speed: the same bounds and alerts in every bit. A run or a log is judged as if it arrived."""
    from navbound import live  # noqa: PLC0415
    from navbound.live.replay import is_journal, settings_of  # noqa: PLC0415

    _check_speed(speed)
    if group < 1:
        raise InputError("group", group, "1", "[1, inf)")
    shown = _Screen(port if display or open_page else None, json=json, opened=open_page)
    if not is_journal(recording):
        settings = _settings(str(recording), form, spec=spec or "RNP 0.3", path=path, sigma_m=sigma_m)
        _run(str(recording), settings, _Ways(out, speed, shown, limits=_limits(level), json=json, replay=True))
        return
    own = {"spec": spec, "path": path, "form": form, "sigma_m": sigma_m}
    if declared := [name for name, value in own.items() if value is not None]:
        raise ConflictError(declared[0], because="a journal is judged with the settings of its session")
    stop = stop_requested()
    with shown as screen:
        session = live.replay(
            recording,
            out,
            speed=speed,
            group=group,
            report=report_to(json=json),
            stop=stop,
            say=say,
            started=screen.show,
            limits=_limits(level),
        )
        ended(session, settings_of(recording), json=json)
        screen.hold(stop)


@app.command()
def display(
    folder: Annotated[Path, typer.Argument(help="Folder of a session that runs, or ran.")],
    port: DisplayPort = 0,
) -> None:
    """Show a session in a browser on this host, from its journals alone; Ctrl-C ends the display and not the session."""
    from navbound.live.display import Options, serve  # noqa: PLC0415

    serve(folder, Options(port), ready=lambda server: address(server.address, json=False), stop=stop_requested())


@app.command()
def send(
    folder: Annotated[Path, typer.Argument(help="Folder of a session that runs, or ran.")],
    webhook: Annotated[
        str, typer.Option("--webhook", help="Address that each transition is sent to: https://..., or http:// on this host.")
    ],
    secret_file: SecretFile = None,
) -> None:
    """Send the transitions of a session to a webhook, in order, from its journal alone, until each was taken and the session has ended.

    Who was stopped or killed goes on where it was. Ctrl-C ends the sending and not the session.
    """
    from navbound.live.sinks.webhook import Webhook  # noqa: PLC0415

    target = _target(webhook, secret_file)
    if target is not None:
        sender = Webhook(folder, target, say=say)
        sender.run(stop=stop_requested())
        out_console.print(
            f"{counted(sender.n_sent, 'transition')} taken by {target.name}, {sender.n_waiting} "
            f"{agreeing(sender.n_waiting, 'waits', 'wait')}.",
            highlight=False,
        )
        if sender.n_waiting:
            raise typer.Exit(NO_VERDICT)


@app.command()
def counts(folder: Annotated[Path, typer.Argument(help="Folder of a session that runs, or ran.")]) -> None:
    """Print what a session counted, as Prometheus reads it at /metrics of the display: from the journal out and the last snapshot."""
    from navbound.live.sinks import metrics  # noqa: PLC0415

    typer.echo(metrics.of(folder), nl=False)


@app.command()
def judge(journal: Journal, out: SessionOut = Path("out/judged"), json: JsonLines = False) -> None:
    """Judge a whole journal at once: the causal batch."""
    from navbound import live  # noqa: PLC0415
    from navbound.live.replay import settings_of  # noqa: PLC0415

    ended(live.judge(journal, out, say=say), settings_of(journal), json=json)


@app.command()
def compare(a: Annotated[Path, typer.Argument(help="Folder of a session.")], b: Annotated[Path, typer.Argument(help="Another.")]) -> None:
    """Compare every bound, status, alert and transition of two sessions of the same data as bits; exit status 70 where one differs."""
    from navbound import live  # noqa: PLC0415

    result = live.compare(a, b)
    where = "" if result.first is None else f", the first at {result.first}"
    out_console.print(
        f"{counted(result.n_epochs, 'epoch')} and {counted(result.n_transitions, 'transition')} compared: {result.n_differing} "
        f"{agreeing(result.n_differing, 'differs', 'differ')}{where}.",
        highlight=False,
    )
    if result.apart is not None:
        raise FormatError(b, f"is no other judgement of the session in {a}: {result.apart}")
    if result.n_differing:
        raise typer.Exit(OUR_BUG)
