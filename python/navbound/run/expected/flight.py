"""The prediction of a flight, as a record and an epoch table; and the folder that it leaves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import __version__
from navbound.algorithms import Place, Sent, entries, entry
from navbound.errors import FormatError, InputError
from navbound.records.prediction import ExpectedFlight, Shift
from navbound.run.expected.hold import hold
from navbound.run.expected.legs import legs
from navbound.run.expected.mixture import without_hole
from navbound.run.expected.page import WORDS, clock, sections
from navbound.run.expected.setup import setup
from navbound.run.expected.table import instants, levels, pairs, seconds
from navbound.scenario.plan import read_plan
from navbound.storage import folders
from navbound.time import utc_text
from navbound.units import METRES_PER_NM
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from navbound.records.prediction import ExpectedLeg
    from navbound.run.expected.setup import Setup
    from navbound.scenario.plan import Plan

RECORD, EPOCHS, PAGE = "prediction.json", "epochs.parquet", "page.html"
DISPATCH_HOLE_S = 300.0
"""A longer hole of RAIM speaks against dispatch: printed, EUROCONTROL's AUGUR. [s]"""


@dataclass(frozen=True)
class Expected:
    """A prediction: its record, its table by seconds and the rows that are shown."""

    record: ExpectedFlight
    seconds: pl.DataFrame
    shown: pl.DataFrame


def predict_flight(file: str | Path, *, command: str = "", with_hold: bool = True) -> Expected:
    """Predict the navigation of a planned flight.

    Parameters
    ----------
    file : str or Path
        The plan.
    command : str, optional
        What the user typed, for the record.
    with_hold : bool, optional
        Work out how long each RNP is kept without aids, too.

    Raises
    ------
    FormatError
        A plan that is none: file, key and what is allowed.
    """
    plan = read_plan(file)
    _check_monitor(file, plan)
    prepared = setup(file, plan)
    table = seconds(prepared)
    rows = table[instants(prepared, table).tolist()]
    shown = rows.hstack(levels(prepared, rows)).hstack(pairs(prepared, rows))
    lines, holes = legs(prepared, table, shown)
    probable, p_unexamined = without_hole(prepared, rows, [(line.start_s, line.end_s) for line in lines])
    if probable is not None:
        known = [p if line.rnp_m is not None else None for line, p in zip(lines, probable, strict=True)]
        lines = [line.model_copy(update={"p_without_hole": p}) for line, p in zip(lines, known, strict=True)]
    shifts = [_shift(prepared, rows, shift_s) for shift_s in plan.departure_shifts_s]
    record = ExpectedFlight(
        navbound_version=__version__,
        command=command,
        title=plan.title,
        scenario=plan.flight,
        departure_utc=utc_text(prepared.scenario.start_ns) if prepared.dated else None,
        duration_s=prepared.scenario.duration_s,
        length_m=float(table["along_m"][-1]),
        orbits=plan.orbits or ["nominal"],
        satellites=list(prepared.orbits.satellite),
        monitor=plan.equipment.monitor,
        monitor_systems=prepared.systems(),
        mask_rad=prepared.scenario.sensors.gnss.mask_rad if prepared.scenario.sensors and prepared.scenario.sensors.gnss else 0.0,
        fte_95_m=prepared.fte_95_m[0],
        outages=prepared.windows,
        p_unexamined=p_unexamined,
        legs=lines,
        holes=holes,
        shifts=shifts,
        hold=hold(prepared) if with_hold else [],
        words=_sentences(lines, _shift(prepared, rows, 0.0), table),
        warnings=prepared.warnings,
        assumptions=_assumptions(prepared),
    )
    return Expected(record, table, shown)


def _check_monitor(file: str | Path, plan: Plan) -> None:
    """Refuse a monitor that is not known, or without what it needs."""
    monitor = plan.equipment.monitor
    if monitor in entries(Sent):
        if plan.sbas is None:
            raise FormatError(file, f"{monitor!r} needs [sbas] with messages that were sent before", field="equipment.monitor")
        return
    if plan.sbas is not None:
        raise FormatError(file, f'is for equipment.monitor = "sbas"; the monitor is {monitor!r}', field="sbas")
    try:
        entry(Place, "monitor", monitor)
    except InputError as e:
        raise FormatError(file, f"{e}; or {', '.join(entries(Sent))}", field="equipment.monitor") from e


def _shift(prepared: Setup, rows: pl.DataFrame, shift_s: float) -> Shift:
    """Levels of the same rows with another departure; a hole goes on over legs here."""
    rnp_m = rows["rnp_m"].to_numpy()
    stated = np.isfinite(rnp_m)
    if not stated.any():
        return Shift(shift_s=shift_s, p_level=None, n_holes=None, longest_hole_s=None)
    inside = levels(prepared, rows, shift_s)["hpl_m"].to_numpy() <= rnp_m
    # Where nobody has stated an RNP there is neither a level inside it nor a hole.
    good = (inside | ~stated).tolist()
    times = [*rows["time_s"].to_list(), float(rows["time_s"][-1]) + 1.0]
    lengths, begin = list[float](), None
    for k, fine in enumerate([*good, True]):
        if not fine and begin is None:
            begin = times[k]
        elif fine and begin is not None:
            lengths.append(times[k] - begin)
            begin = None
    return Shift(shift_s=shift_s, p_level=float(inside[stated].mean()), n_holes=len(lengths), longest_hole_s=max(lengths, default=0.0))


def _sentences(lines: list[ExpectedLeg], level: Shift, table: pl.DataFrame) -> list[str]:
    broken = [line for line in lines if line.status not in {"kept", "no_rnp"}]
    n_unknown = sum(line.status == "no_rnp" for line in lines)
    judged = f"{len(lines)} legs" if not n_unknown else f"{len(lines) - n_unknown} legs that have one"
    without = f" {n_unknown} of {len(lines)} legs have no RNP: nothing is said of them." if n_unknown else ""
    if broken:
        first = min(broken, key=lambda line: line.first_without_s if line.first_without_s is not None else line.end_s)
        words = [
            f"Accuracy: RNP is not kept on {len(broken)} of {judged}; first on {first.leg} (RNP {(first.rnp_m or 0.0) / METRES_PER_NM:g}) "
            f"from {clock(first.first_without_s or first.start_s)} on.{without}"
        ]
    elif n_unknown == len(lines):
        words = ["Accuracy: nothing is judged, no leg has an RNP."]
    else:
        words = [f"Accuracy: RNP is kept on all {judged}, the 95 % total error across the path is within it at every second.{without}"]
    circle = table["anp_circle_m"].fill_nan(None)
    worst = circle.arg_max()
    if worst is not None:
        words.append(f"The largest 95 % circle of navigation is {circle[worst]:.0f} m at {clock(worst)}, mode {table['mode'][worst]}.")
    words += [f"No satellite is used from {clock(a)} to {clock(b)}; mostly {mode}." for a, b, mode in _without_satellites(table)]
    if level.n_holes is None or level.longest_hole_s is None:
        words.append("Integrity: no leg has an RNP that a protection level could be compared with.")
    elif level.n_holes == 0:
        of = " of a leg that has one" if n_unknown else ""
        words.append(f"Integrity: the protection level of the monitor is inside the RNP at every instant{of}.")
    else:
        lasts = level.longest_hole_s
        beyond = f", longer than the {DISPATCH_HOLE_S / 60:g} min up to which dispatch is usual" if lasts > DISPATCH_HOLE_S else ""
        words.append(f"Integrity: {counted(level.n_holes, 'hole')} of the protection level; the longest is {lasts / 60:.1f} min{beyond}.")
    return words


def _without_satellites(table: pl.DataFrame) -> list[tuple[float, float, str]]:
    """Runs of seconds without a satellite, with the mode of most of it."""
    runs, begin = list[tuple[float, float, str]](), None
    none = [*(table["n_sv"] == 0).to_list(), False]
    for k, absent in enumerate(none):
        if absent and begin is None:
            begin = k
        elif not absent and begin is not None:
            shares = table["mode"][begin:k].value_counts(sort=True)
            # The first instant of a flight is before the first measurement.
            if k - begin > 1:
                runs.append((float(begin), float(k), str(shares["mode"][0])))
            begin = None
    return runs


def _assumptions(prepared: Setup) -> list[str]:
    equipment = prepared.plan.equipment
    en_route, approach = (fte / METRES_PER_NM for fte in prepared.fte_95_m)
    mark = "stated in the plan" if equipment.fte_95_m is not None else "inferred, clause unknown"
    orbits = "Satellites of the files in the plan." if prepared.from_files else "Satellites in nominal constellations of no date."
    return [
        "The covariance is that of the flight's own filter on a flight whose sensors have no errors.",
        "What a filter rejects in the air, and what it adds to its covariance for a measurement that contradicts it, is not known before.",
        f"{orbits} {_failures(prepared)}",
        *prepared.orbits.notes,
        *prepared.path_words,
        f"Flight technical error, 95 %: {en_route:g} NM, on approach {approach:g} NM ({mark}).",
        f"The levels are those of {equipment.monitor} with the satellites of {prepared.systems()}; the alert limit is the RNP (inferred).",
        *(entry(Place, "monitor", equipment.monitor).words(equipment.model) if prepared.sbas is None else prepared.sbas.words()),
        "Stations are used within the coverage that the scenario states and above a horizon of a smooth Earth; terrain is not modelled.",
        f"The risk on a leg takes a correlation time of {equipment.fte_correlation_s:g} s (inferred).",
    ]


def _failures(prepared: Setup) -> str:
    equipment = prepared.plan.equipment
    if equipment.satellite_outage_probability == 0.0:
        return "None fails unless a notice says so: the probability of an outage is taken as zero."
    return (
        f"Each is out of service without a notice with probability {equipment.satellite_outage_probability:g} (stated in the plan), "
        f"independently; up to {equipment.outages} at once were worked out, more count as a hole. The covariance has all of them."
    )


def write(expected: Expected, folder: str | Path) -> Path:
    """Leave the record, the table by seconds and the page in a folder, whole or not at all.

    Raises
    ------
    FormatError
        It cannot be written, or holds files that are not a prediction's.
    """
    from navbound.report.expected import Section, page  # noqa: PLC0415  (only where one is written)

    table = expected.seconds.join(
        expected.shown.select("time_ns", "hpl_m", "n_sv_monitor", "jammed", "n_dme", "dme_pair", "dme_circle_m"), on="time_ns", how="left"
    )
    table = table.with_columns(pl.col(pl.Float64).fill_nan(None))
    with folders.own(Path(folder), {RECORD, EPOCHS, PAGE}, "a prediction's") as target:
        target.text(RECORD, expected.record.model_dump_json(indent=1) + "\n")
        target.write(EPOCHS, table.write_parquet)
        tables = [Section(*part) for part in sections(expected.record)]
        warned = [words for status, words in WORDS.items() if status != "kept"]
        target.text(PAGE, page(expected.record, expected.seconds, expected.shown, tables, warned))
    return Path(folder)


__all__ = ["EPOCHS", "PAGE", "RECORD", "Expected", "predict_flight", "write"]
