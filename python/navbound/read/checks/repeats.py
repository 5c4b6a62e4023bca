"""Rows of one track and one time: the same again, or another position or bound, of which none can be believed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import polars as pl

from navbound import status
from navbound.read.checks.stated import ALERT
from navbound.records.material import LEFT_OUT
from navbound.table.columns import COVARIANCE, VARIANCES
from navbound.units import EARTH_RADIUS_M
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

SAME_PLACE_M = 1.0
"""Distance up to which two positions of one time are one, written with other digits. [m] Provenance: ours; five decimals of a degree."""

SAME_ALTITUDE_M = 50.0
"""The same of two barometric altitudes. [m] Provenance: ours; steps of 100 ft, and a little more."""


SAME_BOUND = 0.01
"""Relative difference up to which two numbers of an accuracy or a bound are one, written with other digits. [1] Provenance: ours."""

HEAPED = 10
"""So many times as many rows of one time as is usual in the table are epochs of unknown times: logs that are joined twice repeat a row
once, and of several messages an instant there are as many at each. Where the positions move meanwhile, the clock stands. [1]
Provenance: ours."""

STEP_S = 1.0
"""Step of stamps that are whole seconds: within it two positions of one stamp may be two fixes. [s]"""

MOVING_MPS = 15.0
"""Reported speed from which they may be; what stands or creeps is in one place for a second. [m/s] Provenance: ours."""

FASTER, AHEAD_M, ASIDE, CLIMB, HEIGHTS_M = 1.25, 5.0, 0.05, 0.25, 8.0
"""How far the second of them may lie from the first, with the larger reported speed v: ahead by `FASTER` v and `AHEAD_M`, aside and
behind by `ASIDE` v and `AHEAD_M`, in height by `CLIMB` v and `HEIGHTS_M`. [1, m, 1, 1, m] Provenance: ours; steps of the coding of a
position and of 25 ft, a turn of 17 m/s2, a reported direction that is 3 degrees off."""

BOUNDS = ("sigma_e_m", "sigma_n_m", "sigma_u_m", "epu_m", "rc_m", "nac_p", "nic", "nuc_p", "pic", "hpl_m", "vpl_m", "hpe_m", "vpe_m")
"""What a row states of its accuracy or its bound, beside its covariance."""

ERRORS = ("nse_e_m", "nse_n_m", "nse_u_m", "stated_error_m", "truth_h_m")
"""What a row states of its error, or of its true height. Two of one time are one as two positions are."""

_MEASURED = ("est_lat_rad", "est_lon_rad", "est_h_m", "altitude_m", "ground_speed_mps", "ground_track_rad")
"""What a receiver measures anew at each row."""

_EAST, _NORTH, _UP = VARIANCES
SIZES = dict(
    zip(COVARIANCE, ((_EAST, _EAST), (_EAST, _NORTH), (_NORTH, _NORTH), (_EAST, _UP), (_NORTH, _UP), (_UP, _UP)), strict=True),
)
"""Entries of a covariance and the variances whose geometric mean is their size: a correlation near zero has no size of its own."""

_OTHER_PLACE = "another position has the same time"
_OTHER_BOUND = "another accuracy, bound, error or true position has the same time"


@dataclass(frozen=True)
class Repeats:
    """What became of rows that share a time.

    Attributes
    ----------
    epochs : DataFrame
        One row a time; a contradicted one has status ``invalid_input``.
    kinds : dict of str to DataFrame
        Rows left out, by how their time is repeated in words: those that repeat the kept row, those that cannot be judged, and those
        whose aircraft flew on within the same second, to the position that is kept.
    """

    epochs: pl.DataFrame
    kinds: dict[str, pl.DataFrame]

    @property
    def unjudged(self) -> pl.DataFrame:
        """Rows left out of which each is an epoch that is expected and cannot be judged."""
        unjudged = [self.kinds[kind] for kind in UNJUDGED if kind in self.kinds]
        return pl.concat(unjudged) if unjudged else self.epochs.clear()


IDENTICAL = ""
OTHERWISE = " with another position, bound or status"
STANDS = " by a clock that stands while the positions move"
HEAPS = f" {HEAPED} times as often as is usual in the table, or more; when these rows were is not known"
EARLIER = " by a fix that was flown on from within the same second; the later one counts"
UNJUDGED = (OTHERWISE, STANDS, HEAPS)


def usual_rows(epochs: pl.DataFrame) -> dict[int, int]:
    """How many times of a track have how many rows."""
    counts = epochs.group_by("track", "time_ns").len("n").group_by("n").len("times")
    return dict(counts.select("n", "times").iter_rows())


def median_rows(times_of: Mapping[int, int]) -> int:
    """Rows that half of the times have at most; 1 where there are none."""
    half, so_far = sum(times_of.values()) / 2, 0
    for n, times in sorted(times_of.items()):
        so_far += times
        if so_far >= half:
            return n
    return 1


def without_shared(rows: pl.DataFrame, epochs: pl.DataFrame) -> tuple[pl.DataFrame, int]:
    """Rows that were expected to hold a position, without those that say nothing of a time at which another row of the track has one.

    Several messages of one instant are one epoch. A row that speaks against its position, or of an instant with `HEAPED` rows without a
    position, is none of these: nobody knows whether its stamp is its own. Second: how many there were.
    """
    key = ["track", "time_ns"]
    silent = rows.with_row_index("__row").filter("silent").join(epochs.select(key).unique(), on=key, how="semi")
    shared = silent.filter(pl.len().over(key) < HEAPED)["__row"]
    kept = rows.with_row_index("__row").filter(~pl.col("__row").is_in(shared.implode())).drop("__row")
    return kept, len(shared)


def shared_words(file: str, n: int) -> list[str]:
    """A note on rows that share the instant of a position, where there are any."""
    return (
        [
            f"{file}: {counted(n, 'row')} without a position {agreeing(n, 'has', 'have')} the time of one with a position and "
            f"{agreeing(n, 'counts', 'count')} as one instant with it"
        ]
        if n
        else []
    )


def separate(epochs: pl.DataFrame, *, whole_seconds: bool = False, usual: int = 1) -> Repeats:
    """One row a time out of rows sorted by track and time.

    Two rows of one time contradict each other where their positions lie further apart than `SAME_PLACE_M` (``position_jump``: no vehicle
    is in two places), or where both state an accuracy, a bound, an error or a true position and these differ (``invalid_number``). Nobody
    knows which of them is right, so the epoch is not believed. Where only the statuses differ, the graver counts; an alert of any of them
    counts; and of rows with errors and levels one whose error is above its level: no recorded hazard is left out.

    Where all stamps of the file are rounded to `whole_seconds` two fixes of one second share a stamp. A position that lies where the
    reported speed and direction lead within it is one of them, and the later one in the file counts. `usual` is how many rows of a time
    are usual in the table.
    """
    key = ["track", "time_ns"]
    again = (pl.all_horizontal(pl.col(k) == pl.col(k).shift(1) for k in key)).fill_null(value=False)
    if not epochs.select(again.any()).item():
        return Repeats(epochs, {})
    flown = _flown(epochs, key) if whole_seconds else pl.lit(value=False)
    stands = _stands(epochs, key, whole_seconds=whole_seconds)
    epochs = _later_first(epochs.with_columns(_hazard(epochs).alias("__hazard"), flown.alias("__flown"), stands.alias("__stands")), key)
    epochs = _with_every_alert(_gravest_first(epochs, key), key)
    place, bound = _other_place(epochs, key) & ~pl.col("__flown"), _other_bound(epochs, key)
    status_differs = _differs("status", key) if "status" in epochs.columns else pl.lit(value=False)
    marked = epochs.with_columns(again.alias("__again"), place.alias("__place"), bound.alias("__bound"), status_differs.alias("__status"))
    doubted = _completed(marked, key).with_columns(pl.col("__place", "__bound").any().over(key)).filter(~pl.col("__again"))
    kept = _refused(doubted.drop(_MARKS), doubted.select(_REASON).unnest("reason"))
    repeated = marked.filter("__again")
    # The kept row of the time is one more.
    heaped = pl.len().over(key) + 1 >= HEAPED * usual
    words = (
        pl.when((heaped & pl.col("__place").any().over(key)) | pl.col("__stands"))
        .then(pl.lit(STANDS))
        .when(pl.any_horizontal("__place", "__bound", "__status"))
        .then(pl.lit(OTHERWISE))
        .when(heaped)
        .then(pl.lit(HEAPS))
        .when("__flown")
        .then(pl.lit(EARLIER))
        .otherwise(pl.lit(IDENTICAL))
    )
    kinds = repeated.with_columns(words.alias("__kind")).drop(_MARKS)
    rows_of = {name: kinds.filter(pl.col("__kind") == name).drop("__kind") for name in (IDENTICAL, *UNJUDGED, EARLIER)}
    return Repeats(kept, {name: rows for name, rows in rows_of.items() if not rows.is_empty()})


def _stands(epochs: pl.DataFrame, key: list[str], *, whole_seconds: bool) -> pl.Expr:
    """Rows of a time at which `HEAPED` and more were measured, no two of which are the same.

    Logs that are joined repeat a row, however often, and a vehicle that hovers under a clock that stands has noise. Whole seconds that go
    on are rounded.
    """
    measured = [name for name in _MEASURED if name in epochs.columns]
    if not measured:
        return pl.lit(value=False)
    several = pl.struct(measured).n_unique().over(key) >= HEAPED
    if not whole_seconds:
        return several
    times = epochs.select(key).unique(maintain_order=True).with_columns(next_ns=pl.col("time_ns").shift(-1).over("track"))
    next_ns = epochs.select(key).join(times, on=key, how="left", maintain_order="left")["next_ns"]
    rounded = (pl.lit(next_ns) - pl.col("time_ns") <= int(STEP_S * 1e9)).fill_null(value=True)
    return several & ~rounded


def _completed(epochs: pl.DataFrame, key: list[str]) -> pl.DataFrame:
    """What one row of a time leaves empty is what another of it states, and of two speeds the larger: no row speaks for nothing."""
    numbers = [name for name, kind in epochs.schema.items() if kind.is_numeric() and name not in key]
    speed = [pl.col(name).max().over(key) for name in numbers if name == "ground_speed_mps"]
    others = [pl.col(name).fill_null(pl.col(name).drop_nulls().first().over(key)) for name in numbers if name != "ground_speed_mps"]
    return epochs.with_columns(*others, *speed)


_MARKS = ("__again", "__place", "__bound", "__status", "__hazard", "__flown", "__stands")
_UNKNOWN_BOUND = pl.col("__bound") & ~pl.col("__hazard")
_REASON = pl.struct(
    reason_id=pl.when("__place").then(pl.lit("position_jump")).when(_UNKNOWN_BOUND).then(pl.lit("invalid_number")),
    sentence=pl.when("__place").then(pl.lit(_OTHER_PLACE)).when(_UNKNOWN_BOUND).then(pl.lit(_OTHER_BOUND)),
).alias("reason")


def _hazard(epochs: pl.DataFrame) -> pl.Expr:
    """Whether the error that a row states is above the level that it states, in the plane or in height."""
    have = set(epochs.columns)
    pairs = []
    if "hpl_m" in have:
        errors = [pl.col("hpe_m")] if "hpe_m" in have else []
        errors += [(pl.col("nse_e_m") ** 2 + pl.col("nse_n_m") ** 2).sqrt()] if {"nse_e_m", "nse_n_m"} <= have else []
        pairs += [error > pl.col("hpl_m") for error in errors]
    if "vpl_m" in have:
        pairs += [pl.col(name).abs() > pl.col("vpl_m") for name in ("vpe_m", "nse_u_m") if name in have]
    return pl.any_horizontal(*(pair.fill_null(value=False) for pair in pairs)) if pairs else pl.lit(value=False)


def _with_every_alert(epochs: pl.DataFrame, key: list[str]) -> pl.DataFrame:
    """An alert that one row of a time states is that of all of them."""
    if ALERT not in epochs.columns:
        return epochs
    return epochs.with_columns(pl.col(ALERT).drop_nulls().first().over(key))


def _later_first(epochs: pl.DataFrame, key: list[str]) -> pl.DataFrame:
    """Of the fixes of one second the last of the file first."""
    order = pl.int_range(pl.len())
    within = pl.when("__flown").then(-order).otherwise(order).alias("__order")
    return epochs.with_columns(within).sort(*key, "__order").drop("__order")


def _flown(epochs: pl.DataFrame, key: list[str]) -> pl.Expr:
    """Rows of a time with several positions, of which each lies where the aircraft, from the first of them, was within `STEP_S`."""
    have = set(epochs.columns)
    # Whoever states a covariance or its deviations solved the position for its stamp.
    if not {"est_lat_rad", "est_lon_rad", "ground_speed_mps", "ground_track_rad"} <= have or have & {*COVARIANCE, "sigma_e_m", "sigma_n_m"}:
        return pl.lit(value=False)
    lat, lon, track = pl.col("est_lat_rad"), pl.col("est_lon_rad"), pl.col("ground_track_rad")
    north = EARTH_RADIUS_M * (lat - lat.first())
    east = EARTH_RADIUS_M * lat.cos() * ((lon - lon.first()) / 2).sin() * 2
    way = pl.col("ground_speed_mps").max() * STEP_S
    off = ASIDE * way + AHEAD_M
    ahead, aside = north * track.cos() + east * track.sin(), east * track.cos() - north * track.sin()
    on_the_way = ahead.is_between(-off, FASTER * way + AHEAD_M) & (aside.abs() <= off)
    if "est_h_m" in epochs.columns:
        on_the_way &= ((pl.col("est_h_m") - pl.col("est_h_m").drop_nulls().first()).abs() <= CLIMB * way + HEIGHTS_M).fill_null(value=True)
    if "altitude_m" in epochs.columns:
        altitude = pl.col("altitude_m")
        on_the_way &= ((altitude - altitude.drop_nulls().first()).abs() <= SAME_ALTITUDE_M).fill_null(value=True)
    # What reports no speed or no direction lies nowhere on the way.
    every = (on_the_way & pl.col("ground_speed_mps").is_not_null()).fill_null(value=False).all()
    several = (north**2 + east**2 > SAME_PLACE_M**2).any()
    return (every & several & (way >= MOVING_MPS * STEP_S) & (pl.len() < HEAPED)).over(key)


def _gravest_first(epochs: pl.DataFrame, key: list[str]) -> pl.DataFrame:
    """A hazard first within its time, then the row of the gravest status; a status that the list does not know is the gravest."""
    order = [*key, "__hazard"]
    if "status" not in epochs.columns:
        return epochs.sort(*order, descending=[False, False, True], maintain_order=True)
    place = {id_: k for k, id_ in enumerate(status.STATUSES)}
    rank = pl.col("status").replace_strict(place, default=len(place), return_dtype=pl.Int64)
    # An empty field says nothing.
    return (
        epochs.with_columns(rank.fill_null(-1).alias("__rank"))
        .sort(*order, "__rank", descending=[False, False, True, True], maintain_order=True)
        .drop("__rank")
    )


def _differs(name: str, key: list[str]) -> pl.Expr:
    return (pl.col(name) != pl.col(name).first().over(key)).fill_null(value=False)


def _other_place(epochs: pl.DataFrame, key: list[str]) -> pl.Expr:
    """Further than `SAME_PLACE_M` from the first position of the time, in the plane or in height; `SAME_ALTITUDE_M` in altitude."""
    if not {"est_lat_rad", "est_lon_rad"} <= set(epochs.columns):
        return pl.lit(value=False)
    # A NaN is no small distance.
    here = _same_place("est", key).fill_null(value=False)
    heights = {name: most for name, most in (("est_h_m", SAME_PLACE_M), ("altitude_m", SAME_ALTITUDE_M)) if name in epochs.columns}
    apart = [(pl.col(name) - pl.col(name).drop_nulls().first().over(key)).abs() > most for name, most in heights.items()]
    return pl.any_horizontal(~here, *(each.fill_null(value=False) for each in apart))


def _same_place(prefix: str, key: list[str]) -> pl.Expr:
    """Within `SAME_PLACE_M` of the first position that its time states; null where a row states none."""
    lat, lon = pl.col(f"{prefix}_lat_rad"), pl.col(f"{prefix}_lon_rad")
    north = EARTH_RADIUS_M * (lat - lat.drop_nulls().first().over(key))
    # A meridian and the same one a turn further are one.
    east = EARTH_RADIUS_M * lat.cos() * ((lon - lon.drop_nulls().first().over(key)) / 2).sin() * 2
    return north**2 + east**2 <= SAME_PLACE_M**2


def _other_bound(epochs: pl.DataFrame, key: list[str]) -> pl.Expr:
    """Any number of the accuracy, bound or error that differs from the first that its time states; an empty field states nothing."""
    size = {name: pl.col(name).abs() for name in BOUNDS if name in epochs.columns}
    for name, (one, other) in SIZES.items():
        if {name, one, other} <= set(epochs.columns):
            size[name] = (pl.col(one) * pl.col(other)).sqrt()

    def first(name: str) -> pl.Expr:
        return pl.col(name).drop_nulls().first().over(key)

    differs = [(pl.col(name) - first(name)).abs() > SAME_BOUND * of.max().over(key) for name, of in size.items()]
    differs += [(pl.col(name) - first(name)).abs() > SAME_PLACE_M for name in ERRORS if name in epochs.columns]
    if {"truth_lat_rad", "truth_lon_rad"} <= set(epochs.columns):
        differs.append(~_same_place("truth", key))
    return pl.any_horizontal(*(each.fill_null(value=False) for each in differs)) if differs else pl.lit(value=False)


def _refused(kept: pl.DataFrame, reasons: pl.DataFrame) -> pl.DataFrame:
    if reasons["reason_id"].is_null().all():
        return kept
    if "status" not in kept.columns:
        kept = kept.with_columns(pl.lit("ok").alias("status"))
    return status.overridden(kept, reasons["reason_id"], reasons["sentence"])


_OF_MOTION = ("est_h_m", "altitude_m", "ground_speed_mps", "ground_track_rad", "vertical_rate_mps", "callsign")
"""What a row without a position may state and yet say nothing of one."""


def expected(rows: pl.DataFrame, *, empty: pl.Expr, besides: Sequence[str]) -> pl.DataFrame:
    """Track and time of rows without an epoch, and whether each is ``silent``: without a position, and stating nothing but motion."""
    passed = {"track", "time_ns", "status", "est_lat_rad", "est_lon_rad", *_OF_MOTION, *besides}
    others = [pl.col(name).is_null() for name in rows.columns if name not in passed]
    fine = [(pl.col("status") == "ok").fill_null(value=True)] if "status" in rows.columns else []
    return left_out(rows).with_columns(rows.select(pl.all_horizontal(empty, *fine, *others).alias("silent"))["silent"])


def left_out(rows: pl.DataFrame) -> pl.DataFrame:
    """Track and time of rows that cannot be judged."""
    return rows.select(pl.col(name).cast(dtype) for name, dtype in LEFT_OUT.items())


def unread_rows(track: str, n_rows: int) -> pl.DataFrame:
    """Rows that cannot be taken apart were recorded all the same; nobody knows whose they are, and when."""
    return left_out(pl.DataFrame({"track": [track] * n_rows, "time_ns": None}, schema_overrides={"time_ns": pl.Int64}))
