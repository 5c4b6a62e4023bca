"""`navbound demo`: the first minutes with navbound."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import navbound
from navbound.cli.parts import Bar, command_line, out_console
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from navbound.run.directory import Run

DISTURBED = "beijing-shanghai-interference"
SPOOFED = "beijing-shanghai-spoofed-approach"
REPLAY_SPEED = 60.0
"""Of the flight of two hours: two minutes."""
QUIET = "beijing-shanghai"
QUIET_FLIGHTS = 12
"""One flight has about one independent error: so many are needed before a report can show that the bounds hold."""


def demo_command(
    out: Annotated[Path, typer.Option(help="Folder of the runs.")] = Path("out/demo"),
    live: Annotated[
        bool, typer.Option("--live", help="Fly a spoofed approach and replay it on the flight display, 60 times as fast.")
    ] = False,
) -> None:
    """Fly an approach that is jammed and then spoofed, and twelve quiet flights beside it; say what happened and what to do next."""
    if live:
        _live(out)
        return
    _say("1 of 2: a flight whose satellites are jammed and then spoofed on the approach")
    with Bar("flights", begins(1)) as progress:
        disturbed = navbound.fly(DISTURBED, out=out / "interference", command=command_line(), progress=progress)
    _print_moments(disturbed)
    _say(f"2 of 2: {QUIET_FLIGHTS} flights on which nothing happens")
    with Bar("flights", begins(2)) as progress:
        quiet = navbound.fly(QUIET, flights=QUIET_FLIGHTS, out=out / "quiet", command=command_line(), progress=progress)
    _print_coverage(quiet)
    _say("What to do next")
    _say_next(f"open {disturbed.report}", "in a browser: the page opens on the interference; the key e shows the whole flight")
    _say_next('navbound analyze YOUR_FILE --spec "RNP 0.3"', "a recording of your own: table, receiver's log, or RINEX with orbits")
    _say_next("navbound --help", "every command; `navbound methods` lists every bound with its source")


def _live(out: Path) -> None:
    """A flight of two hours in two minutes, with a spoofed approach at its end."""
    from navbound.cli.live.session import replay  # noqa: PLC0415 - the other demonstration needs none of it

    _say("1 of 2: a flight of two hours whose satellites are spoofed on the approach")
    with Bar("flights", begins(1)) as progress:
        flown = navbound.fly(SPOOFED, out=out / "spoofed-approach", command=command_line(), progress=progress)
    _print_moments(flown)
    _say(f"2 of 2: the same flight on the flight display, {REPLAY_SPEED:g} times as fast: spoofing begins after 110 s; Ctrl-C ends it")
    replay(flown.path or out / "spoofed-approach", out=_free(out / "session"), speed=REPLAY_SPEED, level="NPA", open_page=True)


def _free(folder: Path) -> Path:
    """The folder, or one beside it: a session is never written over another."""
    return next(each for n in range(1, 10_000) if not (each := folder if n == 1 else folder.with_name(f"{folder.name}-{n}")).exists())


def begins(part: int) -> str:
    """The line on standard error when one of the two parts begins."""
    return f"navbound demo: part {part} of 2 begins"


def _say(heading: str) -> None:
    out_console.print(f"\n{heading}", style="bold", markup=False, highlight=False)


def _say_next(command: str, purpose: str) -> None:
    out_console.print(f"  {command}\n      {purpose}", markup=False, highlight=False, soft_wrap=True)


def _print_moments(run: Run) -> None:
    """What happened, against the time to alert."""
    from navbound.time import utc_text  # noqa: PLC0415 - loads numbers

    moments = sorted((moment for fault in run.summary.faults for moment in fault.moments), key=lambda moment: moment.time_ns)
    for moment in moments:
        out_console.print(f"  {utc_text(moment.time_ns)[11:19]} UTC  {moment.words}", markup=False, highlight=False)
    for fault in run.summary.faults:
        out_console.print(f"  Of the {fault.kind}: {fault.outcome_words}.", markup=False, highlight=False)
    _print_report(run)


def _print_coverage(run: Run) -> None:
    """Whether the bounds contained the errors, and with which certainty."""
    verdict = run.summary.verdict
    inside = "not known" if verdict.share_inside is None else f"{100 * verdict.share_inside:.2f} %"
    judged = f"{counted(verdict.n_judged, 'judged epoch')} of {verdict.n_epochs}"
    out_console.print(f"  {verdict.requirement}: the 95 % bound is within it at {inside} of {judged}", markup=False, highlight=False)
    for bound in [] if verdict.belief is None else verdict.belief.bounds:
        interval = f"{100 * bound.coverage_low:.1f} to {100 * bound.coverage_high:.1f} % as from {bound.n_effective:.0f} independent ones"
        contained = f"{100 * bound.coverage:.1f} % of {bound.n} errors ({interval})"
        out_console.print(f"  {bound.method}, stated for {100 * (1 - bound.risk):g} %: contains {contained}", markup=False, highlight=False)
    _print_report(run)


def _print_report(run: Run) -> None:
    out_console.print(f"  Report: {run.report.resolve()}", markup=False, highlight=False, soft_wrap=True)
