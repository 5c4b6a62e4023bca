"""The sentence of an alert has one home: the list that a run's events and the live page use."""

from __future__ import annotations

import re
from pathlib import Path

from navbound.rnp import alerts

ROOT = Path(__file__).parents[1]


def test_every_kind_of_the_core_has_its_sentence() -> None:
    live = (ROOT / "crates" / "live" / "src" / "output.rs").read_text(encoding="utf-8")
    names = re.findall(r"Self::(\w+)", live.partition("pub const ALL")[2].partition("];")[0].partition("=")[2])
    kinds = [re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower() for name in names]
    assert len(kinds) >= 8
    assert list(alerts.ALERT_WORDS) == kinds


def test_no_other_source_holds_a_sentence() -> None:
    sources = [*(ROOT / "python" / "navbound").rglob("*.py"), *(ROOT / "web" / "src").rglob("*.ts")]
    holding = {
        path.relative_to(ROOT).as_posix()
        for path in sources
        for text in [path.read_text(encoding="utf-8")]
        if any(f'"{words}"' in text for words in alerts.ALERT_WORDS.values())
    }
    assert holding == {"python/navbound/rnp/alerts.py", "web/src/records.gen.ts"}


def test_the_live_page_has_no_sentences_of_its_own() -> None:
    text = (ROOT / "web" / "src" / "live" / "alerts.ts").read_text(encoding="utf-8")
    assert "ALERT_WORDS" in text
    assert not re.search(r"\b(warning|caution|unavailable): \"", text)


def test_the_length_of_a_nautical_mile_stands_once_in_the_sources_of_the_page() -> None:
    holding = [p.name for p in (ROOT / "web" / "src").rglob("*.ts") if re.search(r"\b1852\b", p.read_text(encoding="utf-8"))]
    assert holding == ["scene.ts"]
