"""Logs of receivers: their own positions, covariances and protection levels, decoded in Rust.

What the fields mean stands in docs/methods/formats.md with its source.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import polars as pl

from navbound import _core, status
from navbound.errors import FormatError
from navbound.read.formats import MESSAGES
from navbound.table.columns import COVARIANCE
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from navbound.read.source import Source

_REASONS = {
    "accuracy_without_position": "accuracy of no position (GST or GBS without a position of its time)",
    "contradicted": "position that another statement of its epoch speaks against",
    "damaged_message": "damaged message",
    "damaged_other_message": "damaged message of no position",
    "implausible_dilution": status.REASONS["implausible_dilution"].words,
    "marked_invalid": "position marked invalid",
    "no_3d_fix": "no 3-D fix",
    "no_fix": "no fix",
    "no_position": "no position",
    "no_such_leap_second": "second 60 on a day that had none",
    "outside_domain": "position or time outside its domain",
    "time_not_known": "time not known",
    "time_not_valid": "time not valid",
}
_NOTES = {
    "circular_covariance": "without NAV-COV the covariance is circular, of hAcc (root of both horizontal variances) and vAcc",
    "worse_accuracy": "hAcc or vAcc is worse than NAV-COV beside it; the covariance was enlarged to it",
    "worse_expected_errors": "the expected errors of GBS are worse than GST beside them; the covariance was enlarged to them",
    "datum": "datum {0} of the receiver is not WGS-84; positions are taken as they stand",
    "error_of_no_share": "PGRME states an error and not its share of errors: that of the plane is taken for the standard deviation of each "
    "axis, which is careful for a share of 39 % or more (ours)",
    "expected_errors": "without GST the expected errors of GBS stand for standard deviations",
    "of_rmc": "no GGA comes, so positions are those of RMC, which states no height, number of satellites, dilution or accuracy of its own",
    "no_separation": "GGA without the separation of the geoid: heights are left out",
    "risk_of_levels": "protection levels of NAV-PL, for a misleading-information risk of {0}e{1} an hour",
    "uncorrelated": "BESTPOS states standard deviations; axes taken as uncorrelated, which the file does not say",
}
_DAMAGED = ("damaged_message", "damaged_other_message")
_COUNTS = ("n_rows", "absent_ns", "n_outside", "undated", "fields", "notes", "left_out", "cov_m2")


@dataclass(frozen=True)
class Log:
    """Positions of a log and a count of what did not become one.

    Attributes
    ----------
    epochs : DataFrame
        Columns of docs/notation.md, with ``record``, the number of the message from 1, and ``few``, the number of satellites in words
        where they are too few for a position that is used, else null.
    n_rows : int
        Positions in the log, used or not.
    left_out : list of (str, bool, int, int, str)
        Reason, whether the message is damaged, count, first record, example.
    absent_ns : list of int or None
        GPS times of the epochs without a usable position, None where it is not known. [ns]
    columns : dict
        Quantity to the message and field it was read from.
    notes : list of str
        Doubts that a person should settle.
    """

    epochs: pl.DataFrame
    n_rows: int
    left_out: list[tuple[str, bool, int, int, str]]
    absent_ns: list[int | None]
    columns: dict[str, str]
    notes: list[str]


def read(source: Source, name: str) -> Log:
    """Positions of a log.

    Raises
    ------
    FormatError
        No message with a position, or positions that nothing dates.
    """
    log = _core.read_positions(source.content, name)
    left_out = [(_REASONS[reason], *of) for reason, *of in log["left_out"]]
    if log["undated"] is not None:
        n_damaged = sum(count for reason_id, _, count, *_ in log["left_out"] if reason_id in _DAMAGED)
        sentence = "GGA" if b"GGA," in source.content else "RMC"
        raise FormatError(source.path, _undated(log["n_rows"], n_damaged, sentence), log["undated"], "date")
    if log["n_rows"] == 0:
        what = f"a log of kind {name} without a message that positions are read from ({MESSAGES[name]})"
        raise FormatError(source.path, what + _places_alone(source) + _solvable(source))
    epochs = _epochs(log)
    notes = _notes(source, log)
    if not epochs[COVARIANCE[0]].is_finite().any() and (solvable := _solvable(source)):
        notes.append(f"{source.path.name}: its positions state no covariance{solvable}")
    return Log(epochs, log["n_rows"], left_out, log["absent_ns"], log["fields"], notes)


def _epochs(fields: dict[str, Any]) -> pl.DataFrame:
    plain = {name: column for name, column in fields.items() if name not in _COUNTS}
    out = pl.DataFrame(plain, schema_overrides={"n_sv": pl.Int64, "record": pl.Int64, "few": pl.String})
    return out.with_columns(pl.Series(name, fields["cov_m2"][:, k]) for k, name in enumerate(COVARIANCE))


def _notes(source: Source, fields: dict[str, Any]) -> list[str]:
    notes = [_NOTES[note].format(*numbers) for note, numbers in fields["notes"]]
    if fields["n_outside"]:
        passed_over = f"{fields['n_outside']} of {len(source.content)} bytes"
        notes.append(
            f"{passed_over} {agreeing(fields['n_outside'], 'belongs', 'belong')} to no message that is read (text, other protocols, "
            "or damage)"
        )
    return [f"{source.path.name}: {note}" for note in notes]


_PLACES = re.compile(rb"\$[A-Z]{2}(GLL|GNS),")


def _places_alone(source: Source) -> str:
    """What the sentences of NMEA lack that hold a place and are not read, and what to do."""
    n_of = Counter(match[1].decode() for match in _PLACES.finditer(source.content)) if source.format.id == "nmea" else Counter[str]()
    if not n_of:
        return ""
    counts = " and ".join(counted(n, f"{name} sentence") for name, n in sorted(n_of.items()))
    return (
        f"; its {counts} {agreeing(n_of.total(), 'states', 'state')} latitude and longitude without a date. Switch GGA on in the receiver "
        "(and GST, which states the accuracy), and RMC, which has the date, or write time, lat and lon as a table and state the accuracy "
        "with --sigma-m"
    )


def _solvable(source: Source) -> str:
    """What a log without positions may still be used for."""
    n_epochs, n_records, _ = _core.raw_log(source.content, str(source.path)) or (0, 0, 0)
    if not n_epochs:
        return ""
    orbits = "" if n_records else " (and a RINEX navigation file of its time, as the log holds no orbits)"
    return f"; it holds raw measurements of {counted(n_epochs, 'epoch')}: with --solve{orbits} positions are solved from them"


def _undated(n_positions: int, n_damaged: int, sentence: str) -> str:
    """Sentences that hold a time of day only: what is lacking, and what to do."""
    damaged = (
        f" ({counted(n_damaged, 'sentence is', 'sentences are')} damaged, perhaps those with the date: a wrong checksum refuses one)"
        if n_damaged
        else ""
    )
    return (
        f"{counted(n_positions, f'{sentence} sentence holds', f'{sentence} sentences hold')} a time of day and no date, and no sound RMC "
        f"or ZDA sentence gives one{damaged}; log RMC or ZDA "
        "beside GGA, take out or mend damaged sentences and add one ZDA sentence of the day at the beginning "
        "($GPZDA,hhmmss,dd,mm,yyyy,00,00*checksum), or convert the log to a table with a time"
    )
