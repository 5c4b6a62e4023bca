"""The first sentence of a verdict on a handful of epochs states how few they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import navbound
from test_verdict import first_sentence, table


@pytest.mark.parametrize(("n", "words"), [(1, "of only 1 judged epoch"), (9, "of only 9 judged epochs, up to 1 s apart"), (10, None)])
def test_a_verdict_on_few_epochs_states_their_number(tmp_path: Path, n: int, words: str | None) -> None:
    first = first_sentence(navbound.analyze(table(tmp_path / "a.csv", n)).summary.verdict.words.replace("0.3", "0,3"))
    assert ("thin evidence" in first) == (words is not None)
    assert words is None or words in first


@pytest.mark.parametrize("name", ["alert", "alert_state", "alarm"])
def test_an_alarm_by_another_name_is_weighed(tmp_path: Path, name: str) -> None:
    verdict = navbound.analyze(
        table(tmp_path / "a.csv", 100, added={name: np.where(np.arange(100) < 3, "warning", "normal")})
    ).summary.verdict
    assert (verdict.id, verdict.n_stated_alert) == ("not_shown", 3)
