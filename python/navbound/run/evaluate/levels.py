"""One part of a campaign: a table, or a receiver's observations with the navigation data and the messages of its time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import gnss, sbas, status
from navbound.errors import ConflictError, FormatError, InputError
from navbound.evaluation import sizes
from navbound.gnss.sight_columns import towards
from navbound.kpi.tables import with_larger_error
from navbound.read.checks.places import header_against
from navbound.read.checks.refusals import of_navigation, of_observations, rejections, require_most_epochs, skipped_words
from navbound.read.checks.stated import ALERT, BESIDE_LEVEL, NO_LEVEL, UNREAD_ERROR
from navbound.read.columns.lacking import WITHOUT_LEVEL
from navbound.read.tables.epochs import read
from navbound.read.truth import Truth, with_error, with_truth
from navbound.run.evaluate import sky
from navbound.run.inputs.solving import Solving, require_same_time
from navbound.table.columns import COVARIANCE
from navbound.table.declare import schema
from navbound.table.lookup import named
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from navbound.records.run import Rejection


_NAMES = (
    *("track", "time_ns", "est_lat_rad", "est_lon_rad", "est_h_m", "nse_e_m", "nse_n_m", "nse_u_m", "hpe_m", "vpe_m", "hpl_m", "vpl_m"),
    *COVARIANCE,
    *("n_sv", "hdop", "vdop", "mode", "status", "reason_id", "reason"),
)
SCHEMA = schema(named(_NAMES))
"""Columns of a performance run's epochs."""

BEFORE_NS = 3_600_000_000_000
"""Messages of the hour before the first epoch still count: nothing that a service broadcasts is valid longer."""

SAME = (
    "Errors and protection levels belong to the same solutions: the receiver's pseudoranges with the corrections of the SBAS service, "
    "weighted by its error model, the satellites of the level."
)
"""Stands beside every number of a run on observations and SBAS messages."""

OWN = (
    "No service monitors these satellites: the protection levels are 6.0 and 5.33 standard deviations (the multipliers of SBAS) of the "
    "position's own covariance, a bound of errors that are as the weights say and of no fault. Experimental, not integrity."
)
"""Stands beside every number of a run on observations alone."""


@dataclass(frozen=True)
class Part:
    """What one file gave.

    Attributes
    ----------
    epochs : DataFrame
        Columns of `SCHEMA`.
    n_rows : int
        Rows or epochs in the file.
    rejected : list of dict
        Fields of `Rejection`.
    notes : list of str
        What a person should know.
    experimental : str
        Words that must stand beside levels that no integrity rests on; empty for others.
    ranges : DataFrame, optional
        Ranges with their errors, for the Stanford-ESA diagram; columns of :func:`navbound.kpi.stanford_esa`.
    unread : list of str
        Columns, or words of columns, that speak of integrity by their name and are not understood.
    n_stated_worse : int
        Usable epochs at which the file states an accuracy or an error above its horizontal protection level that no indicator uses.
    heard : DataFrame, optional
        What became of the satellites, where positions were solved here; columns `navbound.table.columns.HEARD`.
    position_doubts : list of str
        Why nothing can be shown of the positions, or of the errors and levels that a table states.
    """

    epochs: pl.DataFrame
    n_rows: int
    rejected: list[dict[str, Any]]
    notes: list[str]
    experimental: str = ""
    ranges: pl.DataFrame | None = None
    heard: pl.DataFrame | None = None
    unread: list[str] = field(default_factory=list)
    n_stated_worse: int = 0
    position_doubts: list[str] = field(default_factory=list)


def from_table(path: Path, truth: Truth, needs: Sequence[str] = ("hpl_m",)) -> Part:
    """Read a table of errors and protection levels, or of positions and protection levels with a truth.

    Parameters
    ----------
    path : Path
        The file.
    truth : Truth
        Where the receiver really was, and what the caller declares of columns.
    needs : sequence of str
        The protection levels that are judged; a file without one of them is refused: availability would be 0 for no fault of the system.

    Raises
    ------
    FormatError
        Not a table, or no time or protection level in it.
    InputError
        Several tracks in one file, or a truth without positions.
    """
    reading = read(path, columns=truth.columns_of_estimates, needs=needs)
    for name in needs:
        if name not in reading.epochs.columns:
            raise FormatError(
                path, f"no column holds this protection level, which the levels to be judged need; {WITHOUT_LEVEL}", field=name
            )
    tracks = reading.epochs["track"].unique().sort().to_list()
    if len(tracks) > 1:
        raise InputError("files", f"{path}: tracks {', '.join(map(str, tracks[:4]))}", domain="the series of one receiver in each file")
    epochs, notes, refused = _without_alerts(reading.epochs), list(reading.notes), list(reading.rejected)
    if truth.stated is not None:
        epochs, words, other, _ = with_truth(epochs, truth)
        notes.append(words)
        refused += [] if other is None else other.rejected
    else:
        epochs, own = _with_own_truth(epochs)
        notes += [f"{path.name}: {each}" for each in own]
    if reading.unused:
        notes.append(f"{path.name}: columns not used: {', '.join(reading.unused)}")
    rejected = [one.model_dump() for one in refused]
    # Columns of Error Extraction say in their own name what they are.
    of_extraction = any(reading.columns.get(name, "").startswith("ee_") for name in ("hpl_m", "vpl_m"))
    return Part(
        uniform(epochs),
        reading.source.n_rows or 0,
        rejected,
        notes,
        sbas.EXTRACTION_LABEL if of_extraction else "",
        unread=reading.unread,
        n_stated_worse=_beside_level(epochs),
        position_doubts=[f"{path.name}: {words}" for words in _faulty_cells(epochs)],
    )


def _beside_level(epochs: pl.DataFrame) -> int:
    if BESIDE_LEVEL not in epochs.columns:
        return 0
    usable = pl.col("status").is_in(status.USABLE) if "status" in epochs.columns else pl.lit(value=True)
    return epochs.filter(usable & pl.col(BESIDE_LEVEL).is_not_null()).height


def _faulty_cells(epochs: pl.DataFrame) -> list[str]:
    """What an error or a level may hide that is written and cannot be one; rows whose position is of no use claim nothing.

    A level of 0 or less is how tables without a status write an outage. Beside the status ``ok`` it is none.
    """
    stated = pl.col("status") if "status" in epochs.columns else pl.lit("")
    words = []
    for column, claims, what in (
        (UNREAD_ERROR, stated.is_in(["", *status.USABLE]), "an error that is no finite number, so that it may be of any size, in {}"),
        (NO_LEVEL, stated == "ok", "a protection level that is none (0 or less, or no number) beside the status ok, in {}"),
    ):
        n = epochs.filter(claims & pl.col(column)).height if column in epochs.columns else 0
        if n:
            words.append(f"not shown: the file states {what.format(counted(n, 'row'))}")
    return words


def _without_alerts(epochs: pl.DataFrame) -> pl.DataFrame:
    """An epoch at which the recording states an alert has no navigation that is available."""
    if ALERT not in epochs.columns:
        return epochs
    rows = epochs if "status" in epochs.columns else epochs.with_columns(pl.lit("ok").alias("status"))
    fault = rows.select(pl.when(pl.col(ALERT).is_not_null()).then(pl.lit("reported")).alias("fault"))["fault"]
    return status.overridden(rows, fault).drop(ALERT)


def _with_own_truth(epochs: pl.DataFrame) -> tuple[pl.DataFrame, list[str]]:
    """Errors from the table's own true positions, where it states no errors; and what became of such columns."""
    have = {name for name in epochs.columns if epochs[name].null_count() < epochs.height}
    if not {"truth_lat_rad", "truth_lon_rad"} <= have:
        return epochs, []
    errors = sorted(have & {"nse_e_m", "hpe_m"})
    if not {"est_lat_rad", "est_lon_rad"} <= have:
        why = f"the errors are those that the table states ({', '.join(errors)})" if errors else "the table holds no estimated positions"
        return epochs, [f"truth_lat_rad and truth_lon_rad are not used: {why}; without estimated positions nothing is compared with them."]
    compared, doubts = with_error(epochs)
    if not errors:
        return compared, [f"Truth: from the file itself. {doubts.words}".rstrip()]
    own = compared.select(h=sizes.horizontal_of_columns(), u="nse_u_m")
    epochs = with_larger_error(epochs.with_columns(_h=own["h"], _u=own["u"]), pl.col("_h"), pl.col("_u")).drop("_h", "_u")
    of_both = f"the larger of what the table states ({', '.join(errors)}) and of its true positions"
    return epochs, [f"Truth: from the file itself; the error of an epoch is {of_both}. {doubts.words}".rstrip()]


class Service:
    """Navigation data and SBAS messages of a campaign, read once for all its observation files.

    Parameters
    ----------
    navigation, logs : sequence of paths
        RINEX navigation files, logs of SBAS messages.
    prn : int, optional
        Which geostationary satellite's messages.
    """

    def __init__(self, navigation: Sequence[Path], logs: Sequence[Path], prn: int | None) -> None:
        self._navigation, self._logs, self._prn = navigation, logs, prn

    @property
    def has_messages(self) -> bool:
        """Whether there are logs of SBAS messages."""
        return bool(self._logs)

    @cached_property
    def navigation(self) -> gnss.Navigation:
        """Broadcast messages of all files."""
        return gnss.read_navigation(list(self._navigation))

    def rejected(self) -> list[Rejection]:
        """What was refused of the navigation files and of the logs."""
        of_logs = [one for path, log in zip(self._logs, self._each, strict=True) for one in rejections(path, log.refused)]
        return [*of_navigation(self.navigation), *of_logs]

    def words(self) -> list[str]:
        """What the preambles say against the times of the logs."""
        return [f"{path.name}: {words}" for path, log in zip(self._logs, self._each, strict=True) for words in log.tag_words()]

    @cached_property
    def _each(self) -> list[sbas.Messages]:
        return [sbas.read(log) for log in self._logs]

    @cached_property
    def _messages(self) -> sbas.Messages:
        """Those of all logs in the order of time."""
        logs = self._each
        time_ns, sender, data = (np.concatenate([getattr(m, name) for m in logs]) for name in ("time_ns", "prn", "data"))
        order = np.argsort(time_ns, kind="stable")
        refused = [r for m in logs for r in m.refused]
        return sbas.Messages(time_ns[order], sender[order], data[order], logs[0].format, logs[0].tag, refused)

    def messages(self, first_ns: int, last_ns: int) -> sbas.Messages:
        """Messages of one satellite that count between two instants.

        Raises
        ------
        InputError
            None of that time; messages of several satellites and none chosen, or a satellite that sent none.
        """
        every = self._messages
        from_, to = np.searchsorted(every.time_ns, [first_ns - BEFORE_NS, last_ns + 1])
        near = replace(every, time_ns=every.time_ns[from_:to], prn=every.prn[from_:to], data=every.data[from_:to])
        if not near.time_ns.size:
            raise InputError("files", ", ".join(map(str, self._logs))[:200], domain="message logs of the time of the observations")
        senders = np.unique(near.prn).tolist()
        listed = ", ".join(map(str, senders))
        if self._prn is None and len(senders) > 1:
            raise ConflictError("files", needs=("prn",), because=f"the logs hold the messages of several satellites, {listed}")
        if self._prn is not None and self._prn not in senders:
            raise InputError("prn", self._prn, domain=f"one of the satellites of the logs: {listed}")
        return near if self._prn is None else near.of(self._prn)


def from_observations(path: Path, service: Service, truth: Truth, *, keep_ranges: bool = False, solving: Solving | None = None) -> Part:
    """Solve a receiver's positions: with the service's corrections and levels, or without messages with the levels of their own covariance.

    Raises
    ------
    FormatError
        A file that cannot be read.
    InputError
        Messages of several satellites and none selected, no message of the time, or ranges requested without truth or with messages.
    """
    observations = gnss.read_observations(path)
    require_most_epochs(observations)
    require_same_time(observations, service.navigation)
    ranges: pl.DataFrame | None = None
    heard: pl.DataFrame | None
    if service.has_messages:
        epochs, notes, heard = _corrected(observations, service, truth)
    else:
        how: dict[str, Any] = {"signals": "single", "systems": "G", "truth_ecef_m": truth.ecef_m, "keep_ranges": True}
        positions = (solving or Solving()).solve(observations, service.navigation, **how)
        epochs, notes = positions.epochs, [OWN, *(f"{name}: {words}" for name, words in positions.models.items())]
        ranges, heard = positions.ranges if keep_ranges else None, positions.heard
    refused = [*of_observations(observations), *service.rejected()]
    notes += [*skipped_words(path.name, observations.skipped), *skipped_words("navigation data", service.navigation.skipped)]
    if truth.stated is not None and truth.ecef_m is None:
        epochs, words, other, _ = with_truth(epochs, truth)
        refused += [] if other is None else other.rejected
        notes.append(words)
    rejected = [one.model_dump() for one in refused]
    doubts = place_doubts(epochs, observations, truth)
    if service.has_messages:
        return Part(uniform(epochs), observations.n_epochs, rejected, notes, heard=heard, position_doubts=doubts)
    errors = None if ranges is None else _range_errors(ranges, epochs)
    own = uniform(_of_own(epochs))
    return Part(own, observations.n_epochs, rejected, notes, sbas.EXTRACTION_LABEL, errors, heard, position_doubts=doubts)


def place_doubts(epochs: pl.DataFrame, observations: gnss.Observations, truth: Truth) -> list[str]:
    """What the position of the file's header says against the solved ones; a truth decides between the two, and nothing is left to say."""
    if truth.stated is not None:
        return []
    header = header_against(epochs, observations)
    return [f"{observations.path.name}: {words}" for words in (*header.doubts, *header.notes)]


def _corrected(observations: gnss.Observations, service: Service, truth: Truth) -> tuple[pl.DataFrame, list[str], pl.DataFrame]:
    """Positions with the corrections of the SBAS service and the levels of those solutions; words about them; their satellites."""
    messages = service.messages(int(observations.time_ns[0]), int(observations.time_ns[-1]))
    positions = sbas.solve(observations, service.navigation, messages, truth_ecef_m=truth.ecef_m)
    notes = [SAME, *service.words(), *(f"{name}: {words}" for name, words in positions.models.items())]
    # Without counts: the same words of many files stand once.
    notes.extend(f"Satellites left out where: {why}." for why in positions.unused)
    return positions.epochs, [*notes, sky.OF_SOLUTIONS], sky.of_service(positions)


def _of_own(epochs: pl.DataFrame) -> pl.DataFrame:
    """Levels of the positions' own covariances."""
    levels = sbas.covariance_levels(np.column_stack([epochs[name].fill_null(np.nan).to_numpy() for name in COVARIANCE]))
    return epochs.with_columns(hpl_m=pl.Series(levels[0], nan_to_null=True), vpl_m=pl.Series(levels[1], nan_to_null=True))


def _range_errors(ranges: pl.DataFrame, epochs: pl.DataFrame) -> pl.DataFrame:
    """Residuals at the estimated position become errors at the true one: the true range is longer by -u . nse."""
    if "nse_e_m" not in epochs.columns:
        raise ConflictError("stanford_esa", needs=("truth",), because="the error of a subset is that against the true position")
    joined = ranges.join(epochs.select("time_ns", "nse_e_m", "nse_n_m", "nse_u_m"), on="time_ns", maintain_order="left")
    return joined.with_columns(range_error_m=pl.col("residual_m") + towards("nse_e_m", "nse_n_m", "nse_u_m")).drop_nulls("range_error_m")


def uniform(epochs: pl.DataFrame) -> pl.DataFrame:
    """Every column of the schema, absent ones null, in the order of time; sizes of the errors from their components."""
    # A table without statuses says nothing against any of its epochs.
    filled = epochs.select(
        (pl.col(name) if name in epochs.columns else pl.lit("ok" if name == "status" else None)).cast(kind).alias(name)
        for name, kind in SCHEMA.items()
    )
    horizontal = sizes.horizontal_of_columns()
    # Of a size and components of one error the larger counts; one component alone is no error of both axes.
    parts = pl.when(horizontal.is_null() & pl.col("hpe_m").is_not_null()).then(pl.max_horizontal(pl.col("nse_e_m", "nse_n_m").abs()))
    return filled.with_columns(
        hpe_m=pl.max_horizontal(horizontal, "hpe_m", parts), vpe_m=pl.max_horizontal(pl.col("nse_u_m").abs(), pl.col("vpe_m").abs())
    ).sort("time_ns", maintain_order=True)
