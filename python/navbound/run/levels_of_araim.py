"""One part of a campaign: a receiver's observations with ARAIM's own positions and protection levels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound import araim, gnss
from navbound.errors import InputError
from navbound.read.epochs import read
from navbound.read.truth import join
from navbound.run.levels_of import Part, uniform

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.run.levels_of import Truth

GIVEN = "given"
"""Protection levels of the files: a table's, those of an augmentation service's messages."""
SOURCES = {GIVEN: "", "araim": "lpv-200", "araim-horizontal": "horizontal"}
"""What protection levels of observations come from, and the ARAIM service of each."""


def service_of(protection: str) -> str:
    """The ARAIM service of a source of protection levels; empty for those of the files.

    Raises
    ------
    InputError
        No such source.
    """
    if protection not in SOURCES:
        raise InputError("protection", protection, domain=f"one of {', '.join(SOURCES)}")
    return SOURCES[protection]


def from_araim(path: Path, records: gnss.Navigation, truth: Truth, service: str) -> Part:
    """Positions, tests and levels of GPS and Galileo pairs, every epoch of an observation file.

    Raises
    ------
    FormatError
        A file that cannot be read.
    """
    observations = gnss.read_observations(path)
    found = araim.watch(observations, records, service=service, truth_ecef_m=truth.ecef_m)
    epochs, notes = found.epochs, [f"{name}: {words}" for name, words in found.models.items()]
    if truth.given is not None and truth.ecef_m is None:
        epochs, words = join(epochs, read(truth.given), truth.tolerance_s)
        notes.append(words)
    return Part(uniform(epochs), observations.n_epochs, [], notes)
