"""`navbound assess`: what was predicted against what was flown."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from navbound.cli.parts import Json, command_line, out_console

if TYPE_CHECKING:
    from navbound.records.prediction import Agreement, Assessment

app = typer.Typer(help="What was predicted against what was flown.", no_args_is_help=True, rich_markup_mode=None)


@app.callback()
def _about() -> None:
    pass


@app.command("prediction")
def prediction_command(
    prediction: Annotated[Path, typer.Argument(help="Folder of navbound predict flight --out.")],
    flight: Annotated[Path, typer.Argument(help="Run directory of navbound fly or analyze, one flight or many.")],
    by: Annotated[str, typer.Option(help="Joined by: time (since the first epoch of each track) or along (the path).")] = "time",
    json: Json = False,
) -> None:
    """Compare the predicted circle with the flown one, and with the true error where it is known."""
    from navbound.run.expected.assess import assess_prediction  # noqa: PLC0415

    assessed = assess_prediction(prediction, flight, by=by, command=command_line())  # type: ignore[arg-type]
    if json:
        sys.stdout.write(assessed.model_dump_json(indent=1) + "\n")
        return
    _show(assessed)


def _show(assessed: Assessment) -> None:
    for sentence in assessed.words:
        out_console.print(sentence, markup=False, highlight=False)
    for title, lines in (("By mode", assessed.agreement), ("By leg", assessed.legs)):
        table = Table(title=title, title_justify="left")
        for heading in (
            "",
            "epochs",
            "ratio 5 %",
            "median",
            "95 %",
            "within 5 %",
            "coverage",
            "limits",
            "independent",
            "NEES / 2",
            "limits",
        ):
            table.add_column(heading)
        for line in lines:
            table.add_row(*_cells(line))
        out_console.print(table)


def _cells(line: Agreement) -> tuple[str, ...]:
    def two(low: float | None, high: float | None, factor: float, form: str) -> str:
        return "-" if low is None or high is None else f"{factor * low:{form}} to {factor * high:{form}}"

    return (
        line.mode,
        str(line.n),
        f"{line.ratio_5:.3f}",
        f"{line.ratio_median:.3f}",
        f"{line.ratio_95:.3f}",
        f"{100 * line.p_within_5_percent:.1f} %",
        "-" if line.coverage is None else f"{100 * line.coverage:.1f} %",
        two(line.coverage_low, line.coverage_high, 100.0, ".1f"),
        "-" if line.n_independent is None else f"{line.n_independent:.0f}",
        "-" if line.nees is None else f"{line.nees:.2f}",
        two(line.nees_low, line.nees_high, 1.0, ".2f"),
    )
