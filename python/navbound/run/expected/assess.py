"""A prediction against flights that followed it: circles, coverage, consistency and modes, by mode and by leg."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import polars as pl
from pydantic import ValidationError

from navbound import __version__, anp, evaluation
from navbound.errors import FormatError, InputError
from navbound.evaluation import sizes
from navbound.records.prediction import Agreement, Assessment, ExpectedFlight
from navbound.run import directory
from navbound.run.expected.flight import EPOCHS, RECORD
from navbound.storage import folders
from navbound.table.columns import HORIZONTAL

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

By = Literal["time", "along"]
NEEDED = ("track", "time_ns", "along_m", "nav_mode", *HORIZONTAL)
ERROR = ("nse_e_m", "nse_n_m")
CLOSE = 0.05
"""Circles this close agree: the acceptance of the specification. [1]"""
RISK = 0.05
WHOLE_FLIGHTS = 20
"""From so many flights on each is one independent epoch: errors that stay for a flight have no other measure."""


def read_prediction(folder: str | Path) -> tuple[ExpectedFlight, pl.DataFrame]:
    """Record and table of a folder that `navbound predict flight --out` left.

    Raises
    ------
    FormatError
        Not such a folder.
    """
    path = Path(folder)
    folders.require_whole(path, (RECORD, EPOCHS), "a prediction of a flight")
    try:
        return ExpectedFlight.model_validate_json((path / RECORD).read_bytes()), pl.read_parquet(path / EPOCHS)
    except OSError as e:
        raise FormatError(path, f"is not a prediction of a flight: {e}") from e
    except (ValidationError, pl.exceptions.PolarsError) as e:
        raise FormatError(path, f"holds a damaged record: {e}") from e


def assess_prediction(prediction: str | Path, flight: str | Path, *, by: By = "time", command: str = "") -> Assessment:
    """Compare a prediction with a run of flights.

    Parameters
    ----------
    prediction, flight : str or Path
        Folders of ``navbound predict flight --out`` and of ``navbound fly`` or ``analyze``.
    by : {"time", "along"}
        What joins them: seconds after the first epoch of each track, or the distance along the path.

    Raises
    ------
    FormatError
        Not such folders, a flight without mode or covariance.
    InputError
        Another word for `by`; no epoch in common.
    """
    if by not in {"time", "along"}:
        raise InputError("by", by, domain="time or along")
    _, table = read_prediction(prediction)
    epochs = directory.load(Path(flight)).epochs
    absent = [name for name in NEEDED if name not in epochs.columns]
    if absent:
        raise FormatError(flight, f"has no column {', '.join(absent)}: a run of a filter has them")
    return compare(table, epochs, by, (str(prediction), str(flight)), command)


def compare(table: pl.DataFrame, epochs: pl.DataFrame, by: By, names: tuple[str, str] = ("", ""), command: str = "") -> Assessment:
    """The same of tables in memory.

    Raises
    ------
    InputError
        No epoch in common.
    """
    joined = _joined(table, epochs, by)
    usable = joined.drop_nulls(["cov_ee_m2", "expected_ee_m2"])
    if usable.height == 0:
        raise InputError("flight", names[1], domain="a flight with epochs that the prediction has too")
    circles = _circle(usable, "expected"), _circle(usable, "cov")
    every = [_of("all", usable, circles)]
    parts = [_of(str(mode), *_part(usable, circles, "mode", mode)) for mode in usable["mode"].unique(maintain_order=True)]
    legs = [_of(str(leg), *_part(usable, circles, "expected_leg", leg)) for leg in usable["expected_leg"].unique(maintain_order=True)]
    agrees = float((joined["mode"] == joined["nav_mode"]).mean())  # type: ignore[arg-type]
    return Assessment(
        navbound_version=__version__,
        command=command,
        prediction=names[0],
        flight=names[1],
        n_tracks=joined["track"].n_unique(),
        joined_by=by,
        p_mode_agrees=agrees,
        agreement=every + parts,
        legs=legs,
        words=_sentences(every[0], agrees),
    )


def _joined(table: pl.DataFrame, epochs: pl.DataFrame, by: By) -> pl.DataFrame:
    """Every flown epoch with the second of the prediction that it belongs to."""
    columns = [pl.col(f"cov_{c}_m2").alias(f"expected_{c}_m2") for c in ("ee", "en", "nn")]
    expected = table.select("time_s", "along_m", "mode", pl.col("leg").alias("expected_leg"), *columns).rename(
        {"along_m": "expected_along_m"}
    )
    parts = list[pl.DataFrame]()
    for track in epochs.partition_by("track", maintain_order=True):
        if by == "time":
            since = (track["time_ns"] - track["time_ns"].min()) / 1_000_000_000
            rows = np.round(since.to_numpy()).astype(np.int64)
            inside = rows < expected.height
        else:
            # The last second at or before the place; a place beyond both ends belongs to none.
            along, path = track["along_m"].fill_null(float("nan")).to_numpy(), expected["expected_along_m"].to_numpy()
            rows = np.searchsorted(path, along, side="right") - 1
            inside = (rows >= 0) & (along <= path[-1])
        kept = track.filter(pl.Series(inside))
        parts.append(kept.hstack(expected[rows[inside].tolist()]))
    return pl.concat(parts)


def _covariance(rows: pl.DataFrame, prefix: str) -> Floats:
    ee, en, nn = (rows[f"{prefix}_{c}_m2"].to_numpy() for c in ("ee", "en", "nn"))
    return np.stack([np.stack([ee, en], -1), np.stack([en, nn], -1)], -2)


def _circle(rows: pl.DataFrame, prefix: str) -> Floats:
    return np.asarray(anp.circle(_covariance(rows, prefix), RISK))


def _part(rows: pl.DataFrame, circles: tuple[Floats, Floats], column: str, value: object) -> tuple[pl.DataFrame, tuple[Floats, Floats]]:
    mask = (rows[column] == value).to_numpy()
    return rows.filter(pl.Series(mask)), (circles[0][mask], circles[1][mask])


def _of(name: str, rows: pl.DataFrame, circles: tuple[Floats, Floats]) -> Agreement:
    expected, flown = circles
    ratio = expected / flown
    low, middle, high = np.quantile(ratio, [0.05, 0.5, 0.95]).tolist()
    known: dict[str, float | None] = dict.fromkeys(
        ("coverage", "n_independent", "coverage_low", "coverage_high", "nees", "nees_low", "nees_high")
    )
    if all(c in rows.columns for c in ERROR):
        known = _against_truth(rows, expected) or known
    return Agreement(
        mode=name,
        n=rows.height,
        ratio_5=low,
        ratio_median=middle,
        ratio_95=high,
        p_within_5_percent=float((np.abs(ratio - 1) <= CLOSE).mean()),
        **known,
    )


def _against_truth(rows: pl.DataFrame, circle: Floats) -> dict[str, float | None] | None:
    """Coverage of the predicted circle and consistency of the predicted covariance, for the epochs that have a truth."""
    error = rows.select(ERROR).to_numpy().astype(np.float64)
    there = np.isfinite(error).all(axis=1)
    if not there.any():
        return None
    error, circle, tracks = error[there], circle[there], rows["track"].to_numpy()[there]
    covariance = _covariance(rows, "expected")[there]
    outside = sizes.horizontal(error) > circle
    whole = evaluation.nees(error, covariance, tracks)
    _, first = np.unique(tracks, return_index=True)
    # The limits depend on the number of independent epochs alone: those of one epoch a flight are those of the flights.
    consistency = evaluation.nees(error[first], covariance[first], tracks[first]) if len(first) >= WHOLE_FLIGHTS else whole
    independent = float(len(first)) if len(first) >= WHOLE_FLIGHTS else float(np.nan_to_num(whole.n_effective, nan=1.0))
    limits = evaluation.containment(int(outside.sum()), len(outside), independent, RISK)
    return {
        "coverage": float(limits.coverage),
        "n_independent": independent,
        "coverage_low": float(limits.coverage_low),
        "coverage_high": float(limits.coverage_high),
        "nees": whole.nees_mean / whole.dimension,
        "nees_low": consistency.nees_low / consistency.dimension,
        "nees_high": consistency.nees_high / consistency.dimension,
    }


def _sentences(every: Agreement, agrees: float) -> list[str]:
    apart = max(abs(every.ratio_5 - 1), abs(every.ratio_95 - 1))
    words = [
        f"Predicted and flown circle agree within {100 * apart:.2g} % at 90 % of the epochs; mode agrees {100 * agrees:.4g} % of the time."
    ]
    if (
        every.coverage is not None
        and every.n_independent is not None
        and every.coverage_low is not None
        and every.coverage_high is not None
    ):
        n_contained = every.coverage * every.n_independent
        words.append(
            f"The predicted circle contained the error at {n_contained:.0f} of {every.n_independent:.0f} independent epochs "
            f"(limits {100 * every.coverage_low:.1f} to {100 * every.coverage_high:.1f} %)."
        )
    else:
        words.append("The flight has no truth: nothing is said of its errors.")
    return words
