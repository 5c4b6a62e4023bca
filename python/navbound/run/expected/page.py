"""Rows of the printed page, in the units of the screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.run.verdict.numbers import length, share
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from navbound.records.prediction import ExpectedFlight

WORDS = {"kept": "kept", "not_kept": "NOT KEPT", "no_stations_known": "NO STATIONS KNOWN", "no_rnp": "NO RNP"}


SHORTEST = 0.01
"""Share of a leg below which a mode is not shown. [1]"""
SMALLEST = 1e-12
"""No normal law is known to hold farther out. [1]"""


def clock(seconds: float) -> str:
    """Time since departure as minutes and seconds."""
    whole = round(seconds)
    return f"{whole // 60:d}:{whole % 60:02d}"


def sections(record: ExpectedFlight) -> list[tuple[str, list[tuple[str, ...]]]]:
    """Every table of the page with its heading."""
    return [
        ("Legs", leg_rows(record)),
        ("Departure shifted", shift_rows(record)),
        ("How long does it hold, all aids but the inertial unit lost", hold_rows(record)),
    ]


def leg_rows(record: ExpectedFlight) -> list[tuple[str, ...]]:
    """Heading and one row a leg."""
    probable = record.p_unexamined is not None
    rows: list[tuple[str, ...]] = [
        (
            "leg",
            "RNP, NM",
            "accuracy",
            "from",
            "to",
            "mode",
            "ANP 95 %",
            "total 95 %",
            "within RNP",
            "first without",
            "level",
            "in limit",
            "longest hole",
            *(["P no hole"] if probable else []),
            "DME pair",
            "risk 2 RNP",
        )
    ]
    for leg in record.legs:
        long = [(mode, part) for mode, part in leg.modes.items() if part >= SHORTEST]
        modes = ", ".join(mode if len(long) == 1 else f"{mode} {100 * part:.0f} %" for mode, part in long)
        rows.append(
            (
                leg.leg,
                "-" if leg.rnp_m is None else f"{leg.rnp_m / METRES_PER_NM:g}",
                WORDS[leg.status],
                clock(leg.start_s),
                clock(leg.end_s),
                modes,
                _length(leg.anp_max_m),
                _length(leg.tse_max_m),
                _share(leg.p_tse_within),
                "-" if leg.first_without_s is None else clock(leg.first_without_s),
                _length(leg.hpl_max_m),
                _share(leg.p_level),
                "-" if not leg.longest_hole_s else clock(leg.longest_hole_s),
                *([_probability(leg.p_without_hole)] if probable else []),
                share(leg.p_dme_pair),
                _risk(leg.risk_2rnp),
            )
        )
    return rows


def shift_rows(record: ExpectedFlight) -> list[tuple[str, ...]]:
    """Heading and one row a departure."""
    rows: list[tuple[str, ...]] = [("departure", "level in limit", "holes", "longest")]
    for shift in record.shifts:
        rows.append(
            (
                f"{shift.shift_s / 60:+.0f} min",
                _share(shift.p_level),
                "-" if shift.n_holes is None else str(shift.n_holes),
                "-" if not shift.longest_hole_s else clock(shift.longest_hole_s),
            )
        )
    return rows


def hold_rows(record: ExpectedFlight) -> list[tuple[str, ...]]:
    """Heading and one row a model, one column an RNP."""
    values = list(dict.fromkeys(h.rnp_m for h in record.hold))
    rows: list[tuple[str, ...]] = [("model", *(f"RNP {m / METRES_PER_NM:g}" for m in values), "provenance")]
    for model in dict.fromkeys(h.model for h in record.hold):
        own = {h.rnp_m: h for h in record.hold if h.model == model}
        cells = []
        for m in values:
            lasts = own[m].hold_s
            cells.append(f"> {own[m].longest_s / 60:.0f} min" if lasts is None else f"{lasts / 60:.0f} min")
        rows.append((model, *cells, next(iter(own.values())).provenance))
    return rows


def _probability(p: float | None) -> str:
    return "-" if p is None else f"{100 * p:.3f} %"


def _risk(risk: float | None) -> str:
    return "-" if risk is None else f"{risk:.1e}" if risk >= SMALLEST else f"< {SMALLEST:g}"


def _share(part: float | None) -> str:
    return "-" if part is None else share(part)


def _length(metres: float | None) -> str:
    return "-" if metres is None else length(metres)
