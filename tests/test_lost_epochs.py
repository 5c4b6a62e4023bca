"""Epochs that cannot be read were measured all the same: they count as not judged, wherever in the recording they stand."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest

import navbound
from navbound import gnss
from navbound.errors import FormatError


@pytest.fixture
def whole(shared_data: Path, tmp_path: Path) -> tuple[Path, Path]:
    folder = shared_data / "gnss" / "taroz_static"
    text = gzip.decompress((folder / "rover.obs.gz").read_bytes()).decode("latin-1")
    path = tmp_path / "whole.obs"
    path.write_text(text, encoding="latin-1")
    return path, folder / "base.nav"


def damaged(path: Path, every: int, *, from_share: float = 0.0) -> Path:
    """With a letter for a digit in the year of every so many epoch lines behind this share of them."""
    lines = path.read_text(encoding="latin-1").splitlines(keepends=True)
    epochs = [k for k, line in enumerate(lines) if line.startswith(">")]
    for k in epochs[int(from_share * len(epochs)) :: every]:
        lines[k] = lines[k].replace("> 20", "> 2O", 1)
    out = path.with_name(f"damaged_{every}_{from_share}.obs")
    out.write_text("".join(lines), encoding="latin-1")
    return out


def test_every_second_epoch_without_a_date_is_half_of_them_not_judged(whole: tuple[Path, Path]) -> None:
    path, navigation = whole
    n = gnss.read_observations(path).n_epochs
    observations = gnss.read_observations(damaged(path, 2))
    assert (observations.n_epochs, observations.n_lost_epochs) == (n // 2, n - n // 2)
    verdict = navbound.analyze([observations.path, navigation]).summary.verdict
    assert verdict.id == "not_shown"
    assert verdict.n_unjudged >= n - n // 2


def test_an_end_without_dates_is_not_judged_either(whole: tuple[Path, Path]) -> None:
    path, navigation = whole
    verdict = navbound.analyze([damaged(path, 1, from_share=0.4), navigation]).summary.verdict
    assert verdict.id == "not_shown"


def test_indicators_over_time_are_refused_where_a_tenth_of_the_epochs_is_lost(whole: tuple[Path, Path]) -> None:
    path, navigation = whole
    with pytest.raises(
        FormatError, match=r"\d+ of \d+ epochs cannot be read, more than the 10% that may be lost; the first: epoch is not a date"
    ):
        navbound.evaluate([damaged(path, 5), navigation], levels="NPA")
