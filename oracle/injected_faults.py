"""Faults added to real pseudoranges: how often an epoch is ``ok``, and how often its error is outside its own circle of risk 1e-5.

A recording in the open is cut down to a few satellites an epoch, selected at random, and one or two of the ranges are made wrong. The cut
recording is written as RINEX 3 and solved through the public functions, so that nothing of the solution is known here. Epochs are minutes
apart: the memory of surroundings has no part in it.

``python oracle/injected_faults.py`` prints the tables of ``docs/methods/gnss-exclusion.md``.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from gnss_weights import recordings
from navbound import gnss
from navbound.methods import bounds

if TYPE_CHECKING:
    from gnss_weights import Recording

CODES = {"G": ("C1C", "D1C", "S1C"), "E": ("C1X", "D1X", "S1X"), "C": ("C2I", "D2I", "S2I")}
GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)


@dataclass(frozen=True)
class Cell:
    """Faults of one kind: how many, their size, and how many satellites are to spare where every constellation has its own clock."""

    systems: str
    faults: int
    fault_m: float
    spare: int


@dataclass(frozen=True)
class Outcome:
    """Epochs with a position; those ``ok``; of these, outside their circle of risk 1e-5 and inside that of 0.05; of all, inside both."""

    epochs: int
    ok: int
    outside: int
    ok_inside_95: int
    inside: float
    inside_95: float


@dataclass(frozen=True)
class Open:
    """A recording in the open, as far as it is needed: values of its ranges, and which satellites stand where."""

    recording: Recording
    values: dict[str, pl.DataFrame]
    sky: pl.DataFrame


def prepared(recording: Recording, systems: str) -> Open:
    """Ranges above the mask with their azimuths, by the whole recording's own solution."""
    values = {}
    for system in systems:
        codes = recording.observations.codes[system]
        kinds = [next(c for c in codes if c.startswith(kind[:2]) and (system != "C" or c == kind)) for kind in CODES[system]]
        frames = [
            recording.observations.column(system, code).select("time_ns", "satellite", pl.col("value").alias(name))
            for code, name in zip(kinds, ("range_m", "doppler_hz", "strength"), strict=True)
        ]
        table = frames[0]
        for other in frames[1:]:
            table = table.join(other, on=["time_ns", "satellite"], how="left")
        values[system] = table
    solved = gnss.solve(recording.observations, recording.navigation, systems=systems, keep_ranges=True)
    assert solved.ranges is not None
    usable = pl.concat([v.select("time_ns", pl.col("satellite").alias("sv")) for v in values.values()])
    return Open(recording, values, solved.ranges.select("time_ns", "sv", "az_rad", "el_rad").join(usable, on=["time_ns", "sv"]))


def selected(sky: pl.DataFrame, cell: Cell, epochs: int, rng: np.random.Generator) -> dict[int, dict[str, float]]:
    """Satellites of each epoch with the fault of each."""
    times = np.array(sky["time_ns"].unique().sort())
    need = 3 + len(cell.systems) + cell.spare
    picked: dict[int, dict[str, float]] = {}
    for time in times[np.linspace(0, len(times) - 1, min(epochs, len(times))).astype(int)]:
        seen = sky.filter(pl.col("time_ns") == time).sort("sv")
        names, azimuth = seen["sv"].to_list(), seen["az_rad"].to_numpy()
        if len(names) < need or any(sum(n.startswith(s) for n in names) < 2 for s in cell.systems):
            continue
        while True:
            some = rng.choice(len(names), need, replace=False)
            # Two of each constellation at least: one alone checks nothing, and is none of these cells' spare.
            if all(sum(names[k].startswith(s) for k in some) >= 2 for s in cell.systems):
                break
        wrong = {int(rng.choice(some))} if cell.faults else set()
        if cell.faults == 2:
            (first,) = wrong
            apart = [(abs(np.angle(np.exp(1j * (azimuth[k] - azimuth[first])))), int(k)) for k in some if k != first]
            wrong.add(min(apart)[1])
        sign = float(rng.choice([-1.0, 1.0]))
        picked[int(time)] = {names[k]: sign * cell.fault_m if int(k) in wrong else 0.0 for k in some}
    return picked


def write(path: Path, source: Open, picked: dict[int, dict[str, float]]) -> None:
    """RINEX 3.03 with one pseudorange, Doppler and strength a satellite."""

    def header(words: str, label: str) -> str:
        return f"{words:<60}{label:<20}\n"

    lines = [header(f"{3.03:9.2f}           OBSERVATION DATA    M", "RINEX VERSION / TYPE"), header("CUT", "MARKER NAME")]
    lines += [header(f"{s}    3 " + " ".join(CODES[s]), "SYS / # / OBS TYPES") for s in source.values]
    first = GPS_EPOCH + timedelta(microseconds=min(picked) // 1000)
    when = f"{first.year:6d}{first.month:6d}{first.day:6d}{first.hour:6d}{first.minute:6d}{first.second:13.7f}     GPS"
    lines += [header(when, "TIME OF FIRST OBS"), header("", "END OF HEADER")]
    rows = {
        (time, satellite): rest
        for table in source.values.values()
        for time, satellite, *rest in table.filter(pl.col("time_ns").is_in(list(picked))).iter_rows()
    }
    for time, satellites in picked.items():
        at = GPS_EPOCH + timedelta(microseconds=time // 1000)
        second = at.second + time % 1_000_000_000 * 1e-9
        lines.append(f"> {at.year} {at.month:02d} {at.day:02d} {at.hour:02d} {at.minute:02d}{second:11.7f}  0{len(satellites):3d}\n")
        for satellite, fault in satellites.items():
            values = list(rows[time, satellite])
            values[0] += fault
            fields = "".join(" " * 16 if v is None else f"{v:14.3f}  " for v in values)
            lines.append(f"{satellite}{fields}".rstrip() + "\n")
    path.write_text("".join(lines), encoding="ascii")


def run(source: Open, cell: Cell, epochs: int = 100, seed: int = 2026) -> Outcome:
    """One cell of the table."""
    rng = np.random.default_rng([seed, cell.faults, int(cell.fault_m), cell.spare, *cell.systems.encode()])
    picked = selected(source.sky, cell, epochs, rng)
    if not picked:
        return Outcome(0, 0, 0, 0, float("nan"), float("nan"))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cut.rnx"
        write(path, source, picked)
        cut = gnss.read_observations(path)
    truth = source.recording.truth_ecef_m
    if truth.ndim == 2:
        place = {int(t): truth[k] for k, t in enumerate(source.recording.observations.time_ns)}
        truth = np.array([place[t] for t in picked])
    table = gnss.solve(cut, source.recording.navigation, systems=cell.systems, truth_ecef_m=truth).epochs
    return outcome(table)


def outcome(table: pl.DataFrame) -> Outcome:
    """Counts of an epoch table with truth."""
    table = table.filter(pl.col("nse_e_m").is_not_null())
    ok = (table["status"] == "ok").to_numpy()
    miss = np.hypot(table["nse_e_m"].to_numpy(), table["nse_n_m"].to_numpy())
    inside = miss <= bounds(table, "anp-circle", 1e-5).bound_m
    inside_95 = miss <= bounds(table, "anp-circle", 0.05).bound_m
    return Outcome(
        len(ok), int(ok.sum()), int((ok & ~inside).sum()), int((ok & inside_95).sum()), float(inside.mean()), float(inside_95.mean())
    )


def table(source: Open, systems: str, epochs: int) -> None:
    """Every cell of one recording."""
    kinds = [(0, 0.0)] + [(faults, size) for faults in (1, 2) for size in (10.0, 30.0, 100.0, 500.0)]
    total = Outcome(0, 0, 0, 0, 0.0, 0.0)
    for faults, size in kinds:
        cells = []
        for spare in range(1, 7):
            o = run(source, Cell(systems, faults, size, spare), epochs)
            cells.append(f"{o.epochs:3d} {o.ok:3d}/{o.outside} {o.inside:.2f} {o.inside_95:.2f}")
            total = replace(total, epochs=total.epochs + o.epochs, ok=total.ok + o.ok, outside=total.outside + o.outside)
            total = replace(total, ok_inside_95=total.ok_inside_95 + o.ok_inside_95)
        print(f"| {source.recording.name} {systems} | {faults} x {size:g} m | " + " | ".join(cells) + " |", flush=True)
    share = 1 - total.outside / max(total.ok, 1)
    print(f"{source.recording.name} {systems}: ok {total.ok} of {total.epochs}, 1e-5 {share:.4f}, 95 % {total.ok_inside_95 / total.ok:.3f}")


def main() -> None:
    """Print the tables."""
    known = recordings()
    day = known["ESBC, first half"]
    for systems in ("G", "GE", "GEC"):
        table(prepared(replace(day, name="ESBC", part=(None, None)), systems), systems, 100)
    table(prepared(known["ARLM"], "G"), "G", 100)
    table(prepared(known["Taroz static rover"], "GE"), "GE", 100)


if __name__ == "__main__":
    main()
