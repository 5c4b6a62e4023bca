"""Where the covariance of a recorded position comes from: stated by the caller, by the file, or by an ADS-B quality indicator."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import polars as pl

from navbound.errors import InputError
from navbound.read.categories import (
    NACP_EPU_M,
    NIC_RC_M,
    NUCP_EPU_M,
    NUCP_RC_M,
    PIC_RC_M,
    SIL_RISK,
    axis_sigma_m,
    circular_sigma,
    nacp_sigma_m,
)
from navbound.read.checks.stated import CONTAINMENT, WORSE, worse_than_covariance
from navbound.read.statements.names import speaks_of_accuracy, speaks_of_level
from navbound.table.columns import COVARIANCE, HORIZONTAL

if TYPE_CHECKING:
    from collections.abc import Sequence

RC_RISK = SIL_RISK[3]
"""Risk taken for a containment radius: source integrity level 3. Provenance: inferred."""

HOLD_S = 300.0
"""How long a quality indicator counts after it was received. Provenance: ours."""


Origin = Literal["file", "file_axes", "epu", "nac_p", "nuc_p", "containment_radius", "typed", "none"]
"""What a covariance was made of."""


@dataclass(frozen=True)
class Claimed:
    """Epochs with the six columns of the covariance, and in words where it came from."""

    epochs: pl.DataFrame
    words: str
    origin: Origin
    own_sigma_m: tuple[float, float] | None = None
    """Least and largest sigma of one axis by the file's own accuracies, where the caller's overrules them. [m]"""


def claim(epochs: pl.DataFrame, sigma_m: float | None = None) -> Claimed:
    """Give every epoch the best covariance at hand, null where there is none.

    In this order: the caller's standard deviation; covariance columns; standard deviations of the axes; a 95 % radius (EPU); NACp; a
    containment radius or NIC; NUCp. A radius R at a risk q becomes a circular covariance with sigma = R / sqrt(-2 ln q).

    Parameters
    ----------
    epochs : DataFrame
        Epoch table.
    sigma_m : float, optional
        Standard deviation of each horizontal axis, the caller's claim; it overrules the file. [m]

    Raises
    ------
    InputError
        `sigma_m` that is not positive and finite.
    """
    if sigma_m is not None:
        if not (math.isfinite(sigma_m) and sigma_m > 0):
            raise InputError("sigma_m", sigma_m, "m", "(0, inf)")
        return _typed(epochs, float(sigma_m))
    # What the table states is read from the table as it is: a covariance that is made of one statement takes the place of another.
    stated, epochs = epochs, _without_others(epochs)
    least_m = _least_radii(epochs)
    claimed = _of_file(epochs, set(epochs.columns))
    whole = worse_than_covariance(_with_containment(claimed.epochs), least_m)
    return replace(claimed, epochs=whole.with_columns(stated[name] for name in _INDICATORS if name in stated.columns))


def _without_others(epochs: pl.DataFrame) -> pl.DataFrame:
    """Without the indicators of rows that are no position of the aircraft's own: what counts on says nothing of the rows after them."""
    if "reason_id" not in epochs.columns:
        return epochs
    own = (pl.col("reason_id") != "reported").fill_null(value=True)
    return epochs.with_columns(pl.when(own).then(pl.col(name)).alias(name) for name in _INDICATORS if name in epochs.columns)


def _typed(epochs: pl.DataFrame, sigma_m: float) -> Claimed:
    """The caller's standard deviation; where the file's own is larger, that speaks against it."""
    own = claim(epochs)
    words = f"Covariance: circular with sigma = {sigma_m:g} m in each axis, as stated by the user."
    typed = _circle(epochs, pl.lit(sigma_m), words, "typed")
    own_m = own.epochs.select(((pl.col("cov_ee_m2") + pl.col("cov_nn_m2")) / 2).sqrt().alias("own")).to_series()
    stated_m = pl.select(
        pl.max_horizontal(pl.lit(each) for each in (own_m / circular_sigma(0.05), *_least_radii(epochs))).alias("m")
    ).to_series()
    worse_m = pl.select(pl.when(stated_m > (1.0 + 1e-9) * sigma_m / circular_sigma(0.05)).then(stated_m)).to_series().alias(WORSE)
    stated = [worse_m, *([own.epochs[CONTAINMENT]] if CONTAINMENT in own.epochs.columns else [])]
    known = own_m.filter(own_m.is_finite().fill_null(value=False))
    if known.is_empty():
        return replace(typed, epochs=typed.epochs.with_columns(stated))
    low, high = float(known.min()), float(known.max())  # type: ignore[arg-type]
    more = f" The file's own accuracies, sigma {low:.3g} to {high:.3g} m, are overruled."
    return Claimed(typed.epochs.with_columns(stated), f"{words}{more}", "typed", (low, high))


def _least_radii(epochs: pl.DataFrame) -> list[pl.Series]:
    """The least 95 % radius by each accuracy of the file; an indicator stands for a class of radii, of which its lower limit. [m]."""
    radii = [pl.col(name) for name in ("epu_m", "unread_accuracy_m") if name in epochs.columns]
    # One axis alone says what the error is at least.
    deviations = [pl.col(f"sigma_{axis}_m") ** 2 for axis in "en" if f"sigma_{axis}_m" in epochs.columns]
    variances = [pl.col(f"cov_{axis}{axis}_m2") for axis in "en" if f"cov_{axis}{axis}_m2" in epochs.columns]
    for squares in (deviations, variances if len(variances) == 1 else []):
        if squares:
            known = pl.any_horizontal(each.is_not_null() for each in squares)
            radii.append(pl.when(known).then((pl.sum_horizontal(squares) / 2).sqrt() / circular_sigma(0.05)))
    # Version 0 states NUCp alone. Decoders write it of later versions too, which state their accuracy as NACp.
    for name, limits in (("nac_p", NACP_EPU_M),) if "nac_p" in epochs.columns else (("nuc_p", NUCP_EPU_M),):
        if name in epochs.columns:
            better = {category: limits.get(category + 1, 0.0) for category in (0, *limits)}
            radii.append(_in_force(name).replace_strict(better, default=None, return_dtype=pl.Float64))
    return epochs.select(radius.alias(str(k)) for k, radius in enumerate(radii)).get_columns()


def _with_containment(epochs: pl.DataFrame) -> pl.DataFrame:
    """Add `CONTAINMENT`, infinite where the indicator says that there is none, and levels that nothing reads."""
    have = set(epochs.columns)
    if not have & {"rc_m", "nic", "nuc_p", "pic", "unread_level_m"}:
        return epochs
    coded = {
        name: _in_force(name).replace_strict(radii | {0: math.inf}, default=None, return_dtype=pl.Float64)
        for name, radii in (("nic", NIC_RC_M), ("nuc_p", NUCP_RC_M), ("pic", PIC_RC_M))
        if name in have
    }
    # Decoders write a radius of 0 where there is none; beside a NIC of 0 no radius is contained.
    radius = pl.when(_in_force("rc_m") > 0.0).then(_in_force("rc_m")).when(_in_force("rc_m").is_not_null()).then(math.inf)
    stated = ([radius] if "rc_m" in have else []) + ([coded["nic"]] if "nic" in have else [])
    without = coded["nic"].is_infinite() if "nic" in have else pl.lit(value=False)
    radii = ([pl.when(without).then(math.inf).otherwise(pl.coalesce(stated))] if stated else []) + (
        [pl.col("unread_level_m")] if "unread_level_m" in have else []
    )
    radii += [coded[name] for name in ("nuc_p", "pic") if name in have]
    return epochs.with_columns(pl.max_horizontal(radii).alias(CONTAINMENT))


def _of_file(epochs: pl.DataFrame, have: set[str]) -> Claimed:
    if set(HORIZONTAL) <= have:
        alone = "cov_uu_m2" in have and not {"cov_eu_m2", "cov_nu_m2"} <= have
        more = " The vertical axis is taken as uncorrelated, which the file does not say." if alone else ""
        words = f"Covariance: as the file gives it.{more}{_beside(have)}"
        return Claimed(_complete(epochs), words, "file")
    if set(_DIAGONAL) <= have:
        filled = epochs.with_columns(
            pl.when(pl.all_horizontal(pl.col(name).is_not_null() for name in _DIAGONAL)).then(0.0).alias("cov_en_m2")
        )
        return Claimed(_complete(filled), f"{_of_axes('variances')}{_beside(have)}", "file_axes")
    if {"sigma_e_m", "sigma_n_m"} <= have:
        squares = {f"cov_{a}{a}_m2": pl.col(f"sigma_{a}_m") ** 2 for a in "enu" if f"sigma_{a}_m" in have}
        filled = epochs.with_columns(pl.lit(0.0).alias("cov_en_m2"), **squares)
        return Claimed(_complete(filled), f"{_of_axes('standard deviations')}{_beside(have)}", "file_axes")
    return _coded(epochs, have)


_DIAGONAL = ("cov_ee_m2", "cov_nn_m2")


def _of_axes(what: str) -> str:
    return f"Covariance: from the file's {what}; axes taken as uncorrelated, which the file does not say."


def _beside(have: set[str]) -> str:
    """Accuracies that the file states beside the one that is used."""
    named = {"epu_m": "EPU", "nac_p": "NACp", "rc_m": "Rc", "nic": "NIC", "nuc_p": "NUCp", "pic": "PIC"}
    others = [words for name, words in named.items() if name in have]
    compared = " One that is larger than twice the distance root mean square speaks against the covariance." if others else ""
    return f" Stated beside it and not used: {', '.join(others)}.{compared}" if others else ""


class Claims:
    """The same for a table that comes in pieces, each the continuation of the one before."""

    def __init__(self, sigma_m: float | None) -> None:
        self._sigma_m = sigma_m
        self._before: pl.DataFrame | None = None
        self._own_m: tuple[float, float] | None = None

    def claim(self, epochs: pl.DataFrame) -> Claimed:
        """The next piece, as :func:`claim`."""
        before = self._before.filter(pl.col("track") == epochs["track"][0]) if self._before is not None else epochs.clear()
        # A status that only some pieces have says nothing here.
        joined = pl.concat([before, epochs], how="diagonal") if before.height else epochs
        claimed = claim(joined.select(epochs.columns), self._sigma_m)
        last = _without_others(joined.filter(pl.col("track") == joined["track"][-1]))
        rows = [last.filter(pl.col(name).is_not_null()).tail(1) for name in _INDICATORS if name in last.columns]
        self._before = pl.concat([last.clear(), *rows]).unique("time_ns").sort("time_ns")
        if claimed.own_sigma_m is not None:
            low, high = self._own_m or claimed.own_sigma_m
            self._own_m = (min(low, claimed.own_sigma_m[0]), max(high, claimed.own_sigma_m[1]))
        return replace(claimed, epochs=claimed.epochs[before.height :], own_sigma_m=self._own_m)


_INDICATORS = ("nac_p", "nic", "nuc_p", "pic", "rc_m")


def _coded(epochs: pl.DataFrame, have: set[str]) -> Claimed:
    """From a radius or a quality indicator."""
    k95, k_rc = circular_sigma(0.05), circular_sigma(RC_RISK)
    coding = "(coding of DO-260B, which was not read)"
    if "epu_m" in have:
        return _circle(epochs, pl.col("epu_m") * k95, f"Covariance: circular, sigma = EPU / {1 / k95:.4f} (EPU is the 95 % radius).", "epu")
    if "nac_p" in have:
        sigma = _in_force("nac_p").replace_strict(nacp_sigma_m(), default=None, return_dtype=pl.Float64)
        words = (
            f"Covariance: circular, sigma = EPU / {1 / k95:.4f}, EPU being the upper limit that NACp stands for {coding}; an indicator "
            f"counts for {HOLD_S:g} s after it was received."
        )
        return _circle(epochs, sigma, words, "nac_p")
    if have & {"rc_m", "nic"}:
        coded = (
            _in_force("nic").replace_strict(NIC_RC_M, default=None, return_dtype=pl.Float64) if "nic" in have else pl.lit(None, pl.Float64)
        )
        contained = _in_force("nic") > 0 if "nic" in have else pl.lit(value=True)
        own = pl.when((_in_force("rc_m") > 0.0) & contained.fill_null(value=True)).then(_in_force("rc_m")) if "rc_m" in have else None
        radius = coded if own is None else pl.coalesce(own, coded)
        words = (
            f"Covariance: circular, sigma = Rc / {1 / k_rc:.4f}, taking the containment radius Rc at a risk of {RC_RISK:g}, source "
            f"integrity level 3 {coding}. Rc is an integrity limit, so this sigma is a stand-in."
        )
        return _circle(epochs, radius * k_rc, words, "containment_radius")
    if "nuc_p" in have:
        sigma = _in_force("nuc_p").replace_strict(axis_sigma_m(NUCP_EPU_M), default=None, return_dtype=pl.Float64)
        words = (
            f"Covariance: circular, sigma = EPU / {1 / k95:.4f}, EPU being the upper limit of the 95 % radius that NUCp stands for "
            f"(coding of DO-260, version 0, which was not read); an indicator counts for {HOLD_S:g} s after it was received."
        )
        return _circle(epochs, sigma, words, "nuc_p")
    return Claimed(epochs.with_columns(pl.lit(None, pl.Float64).alias(c) for c in COVARIANCE), _NONE, "none")


_NONE = (
    "Covariance: none. The file states no accuracy and none was given, so nothing bounds the navigation error: state a sigma (--sigma-m; "
    "in Python sigma_m), or name the columns that hold one (--map; in Python columns)."
)


def words_beside(claimed: Claimed, unread: Sequence[str]) -> str:
    """The words of a claim, given the names of what speaks of integrity in its files and was not understood."""
    accuracies = [each for each in unread if speaks_of_accuracy(each) or speaks_of_level(each)]
    if claimed.origin != "none" or not accuracies:
        return claimed.words
    return _NONE.replace("states no accuracy", f"states accuracies that are not understood ({', '.join(accuracies)})")


def _in_force(name: str) -> pl.Expr:
    """Take the last value received within `HOLD_S`, track by track."""
    since = pl.when(pl.col(name).is_not_null()).then("time_ns").forward_fill().over("track")
    fresh = (pl.col("time_ns") - since) <= int(HOLD_S * 1e9)
    return pl.when(fresh).then(pl.col(name).forward_fill().over("track"))


def _circle(epochs: pl.DataFrame, sigma: pl.Expr, words: str, origin: Origin) -> Claimed:
    epochs = epochs.with_columns((sigma**2).alias("cov_ee_m2"))
    known = pl.col("cov_ee_m2").is_not_null()
    epochs = epochs.with_columns(pl.when(known).then(0.0).alias("cov_en_m2"), pl.col("cov_ee_m2").alias("cov_nn_m2"))
    return Claimed(_complete(epochs.drop(COVARIANCE[3:], strict=False)), words, origin)


def _complete(epochs: pl.DataFrame) -> pl.DataFrame:
    """All six columns; the vertical ones null where nothing is known of them.

    A vertical variance whose correlations the file does not state claims a vertical interval all the same, so they are taken as zero.
    """
    missing = [c for c in COVARIANCE if c not in epochs.columns]
    vertical = pl.col("cov_uu_m2").is_not_null() if "cov_uu_m2" in epochs.columns else pl.lit(value=False)
    correlation = set(COVARIANCE[3:5])
    return epochs.with_columns(
        (pl.when(vertical).then(pl.lit(0.0)) if c in correlation else pl.lit(None, pl.Float64)).alias(c) for c in missing
    )
