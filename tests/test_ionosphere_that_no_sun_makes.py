"""A broadcast message of the ionosphere that no satellite can have sent is missing, with its line and reason."""

from __future__ import annotations

from pathlib import Path

import pytest

from navbound import gnss


def header_of(alpha: float, beta: float) -> str:
    """A navigation file of version 2 with one message and no record of a satellite."""
    lines = [
        f"{'2.10':>9}{'':11}{'N: GPS NAV DATA':<40}RINEX VERSION / TYPE",
        f"{'':2}{f'{alpha:12.4E}' * 4:<58}ION ALPHA",
        f"{'':2}{f'{beta:12.4E}' * 4:<58}ION BETA",
        f"{'':60}END OF HEADER",
    ]
    return "\n".join([*lines, ""])


def navigation(tmp_path: Path, alpha: float, beta: float) -> gnss.Navigation:
    path = tmp_path / "a.20n"
    path.write_text(header_of(alpha, beta), encoding="ascii")
    return gnss.read_navigation([path])


@pytest.mark.parametrize(("alpha", "beta"), [(1e-12, 9e4), (1e3, 9e4), (1e-7, 9e4), (1e-8, 1e12)])
def test_a_message_that_no_satellite_sends_is_refused_with_its_reason(tmp_path: Path, alpha: float, beta: float) -> None:
    read = navigation(tmp_path, alpha, beta)
    assert not read.has_ionosphere
    (refused,) = read.refused
    assert refused.field == "G ionosphere"
    assert "the message counts as missing" in refused.reason


def test_messages_of_ordinary_size_and_empty_ones_are_not_refused(tmp_path: Path) -> None:
    assert navigation(tmp_path, 1e-8, 9e4).has_ionosphere
    assert navigation(tmp_path, 1e-8, 9e4).refused == navigation(tmp_path, 0.0, 0.0).refused == []
