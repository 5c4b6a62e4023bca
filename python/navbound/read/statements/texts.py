"""What the words of a column state of positions, row by row: of a kind that is known, or of a free text."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import polars as pl

if TYPE_CHECKING:
    from collections.abc import Iterable

    from navbound.read.statements.kinds import Kind


@dataclass(frozen=True)
class Stated:
    """What one column states, row by row.

    Attributes
    ----------
    against : Series of str
        The word against the position; null where there is none.
    unknown : list of str
        Words that are not understood, the first few.
    """

    against: pl.Series
    unknown: list[str]


WORDS_SHOWN = 3
"""Words of a column that are named. [1]"""
_SHOWN_CHARACTERS = 60
"""Of a free text. [1]"""
_MISSING = ("", "nan", "null", "na", "n/a")


def stated_in(kind: Kind, raw: pl.Series) -> Stated:
    """Read a column. An empty field states nothing."""
    text = _printable(raw.cast(pl.String, strict=False)).str.strip_chars().str.to_lowercase()
    text = text.str.replace_all(r"[\s\-]+", "_").str.replace(r"^\+?(-?\d+)\.0*$", "$1").str.replace(r"^_(\d)", "-$1")
    value = text.cast(pl.Float64, strict=False)
    number = value.is_not_null() | text.is_in(["true", "false"])
    declared = text.is_not_null() & ~text.is_in(_MISSING)
    fine = text.is_in(_listed(kind.fine))
    against = text.is_in(_listed(kind.against))
    if kind.against_named:
        against |= text.str.contains(kind.against_named) & ~fine
    if kind.fine_begins:
        fine |= text.str.starts_with(kind.fine_begins) & ~against
    unknown = declared & ~fine & ~against
    missing = ~declared.fill_null(value=False)
    empty = missing.any() and kind.effect == "invalid" and not kind.empty_against
    if kind.numbers_unknown:
        unknown, fine = unknown | (declared & number), fine & ~number
    if kind.other_against:
        others = unknown & ~number if kind.numbers_unknown else unknown
        against, unknown = against | others, unknown & ~others
    if kind.above < math.inf:
        # A negative one is none.
        against = ((value > kind.above) | (value < kind.below)).fill_null(value=False)
        unknown, empty = unknown & ~against & (value.is_null() | (value < 0.0)), False
    # A word of an alarm is one in a column of states too.
    alarm = (unknown & ~number & _alarm(text, _STATE_ALARM)).fill_null(value=False)
    against, unknown = against | alarm, unknown & ~alarm
    words = pl.select(pl.when(declared & against & ~fine).then(text)).to_series()
    if kind.empty_against:
        words = pl.select(pl.when(missing).then(pl.lit("nothing")).otherwise(words)).to_series()
    return Stated(
        words, text.filter(unknown.fill_null(value=False)).unique(maintain_order=True).head(WORDS_SHOWN).to_list() + ["empty"] * empty
    )


_ALARM = (
    r"\b(unable|unreliable|invalid|lost|fail|fails|failed|failure|fault|faulty|alarm|alert|warning|misleading|spoof|spoofed|spoofing|jam|jammed|jamming|"
    r"degraded|unhealthy|unsafe|downgrade|downgraded|unavail|unavailable|disagree|inop|loss|doubtful|dead reckoning|outage|exceeded|"
    r"accur low|accuracy low|low accuracy|accur downgrad|map shift|(?:pos|position) uncertain|verify pos(?:ition)?|"
    r"verloren|ungueltig|ungültig|gestoert|gestört|perte|perdue?|invalide|brouillage|perdid[ao]|inválid[ao]|sin señal|"
    r"mlat\d*|multilat\w*|tis b|tisb|irs only|irs nav only|ins only|inertial only|disconnected|extrapolated|simulated data|"
    r"simulated position|(?:gps|gnss) interference|(?:pos|position) (?:frozen|wrong|stuck|offset)|"
    r"(?:wrong|frozen|bad) (?:pos|position)|"
    r"(?:gps|gnss|nav|navigation) integ(?:rity)? lost)\b"
)
_STATE_ALARM = _ALARM.replace("(unable", "(simulated|simulation|simulator|mocked|unable")
"""In a column of states a simulation is of the position, in a free text of anything."""
_NONE = r"\b(no|none|not|without|clear|cleared|off|false|ended|end|over|0)\b"
_NO_POSITION_WORDS = (
    r"\b(no (fix|position|solution|navigation|gps|gnss|raim|integrity|satellite|satellites|computed data)|not to be used|"
    r"not (valid|available|usable|reliable|for nav|for navigation)|"
    r"do not use)\b"
)
"""Words of alarms in a free text, words that take them back, and sentences without either that say the same. Provenance: ours."""


def alarming(texts: pl.DataFrame) -> list[str]:
    """Columns of texts in which any row has a word of an alarm; few have, and a table may have thousands."""
    if not texts.width:
        return []
    words = f"(?i){_ALARM}|{_NO_POSITION_WORDS}".replace(r"\b(", "(").replace(r")\b", ")").replace(" ", r"[\s_-]+")
    has = texts.select(pl.all().str.contains(words).any().fill_null(value=False)).row(0)
    return [name for name, any_row in zip(texts.columns, has, strict=True) if any_row]


def alarms(raw: pl.Series) -> Stated:
    """Read a column of free texts that nothing else reads: a message of a receiver or a crew. A text that takes an alarm back is named."""
    raw = _printable(raw)
    against = _alarm_in_any_part(raw)
    words = pl.select(pl.when(against).then(raw.str.slice(0, _SHOWN_CHARACTERS))).to_series()
    taken_back = _plain_text(raw).str.contains(_ALARM).fill_null(value=False) & ~against
    return Stated(words, raw.filter(taken_back).unique(maintain_order=True).head(WORDS_SHOWN).to_list())


def _printable(raw: pl.Series) -> pl.Series:
    """Without what colours a terminal or moves its cursor: a word stands alone there, and words of a file are printed."""
    return raw.str.replace_all(r"\x1b\[[0-9;]*[A-Za-z]", " ").str.replace_all(r"[\x00-\x1f\x7f]", " ")


def _plain_text(raw: pl.Series) -> pl.Series:
    return raw.str.to_lowercase().str.replace_all(r"[_\-]+", " ")


def _alarm(raw: pl.Series, alarms: str = _ALARM) -> pl.Series:
    """Which texts state an alarm that they do not take back."""
    alarm, none, outright = (_plain_text(raw).str.contains(words).fill_null(value=False) for words in (alarms, _NONE, _NO_POSITION_WORDS))
    return outright | (alarm & ~none)


_PARTS = r"[;|]"
"""What parts statements of a text that say nothing of each other."""


def _alarm_in_any_part(raw: pl.Series) -> pl.Series:
    """The same, where a good word of one statement of a text takes back no alarm of another: `alert=none;integrity=failed`."""
    against = _alarm(raw)
    several = (raw.str.contains(_PARTS) & _plain_text(raw).str.contains(_ALARM) & ~against).fill_null(value=False)
    if not several.any():
        return against
    parts = pl.DataFrame({"at": several.arg_true(), "part": raw.filter(several).str.replace_all(_PARTS, ";").str.split(";")}).explode(
        "part"
    )
    alarming_rows = parts.filter(_alarm(parts["part"]))["at"].unique()
    return against | pl.int_range(len(raw), eager=True).cast(alarming_rows.dtype).is_in(alarming_rows.implode())


def _listed(words: Iterable[str]) -> list[str]:
    return sorted(words)
