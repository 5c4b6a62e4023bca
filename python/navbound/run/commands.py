"""Three of the jobs as functions: fly, analyze and evaluate. The command line is a thin skin over these.

Each loads what it alone needs when it runs: simulators, indicators, procedures.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from navbound.records.performance import Level
from navbound.rnp.requirement import requirement
from navbound.run import analyze as recorded
from navbound.run import directory
from navbound.run.judge import judge
from navbound.run.settings import Settings
from navbound.table.arguments import checked

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Unpack

    from navbound.run.directory import Run
    from navbound.scale import Work


FLIGHTS_IN_MEMORY = 8
"""Flights whose epochs are held in memory; of more they are in pieces on the disk. [1] Provenance: ours; below it the whole takes less than
about 0.25 GB."""
STEPS = 3
"""Of an analysis: reading, judging, writing."""


@checked
def fly(
    scenario: str | Path = "beijing-shanghai",
    *,
    flights: int = 1,
    seed: int | None = None,
    settings: Settings | None = None,
    out: str | Path | None = None,
    command: str = "",
    **work: Unpack[Work],
) -> Run:
    """Fly a scenario and judge every epoch.

    Parameters
    ----------
    scenario : str or Path
        Name of a shipped scenario, or a TOML file.
    flights : int
        How many flights, each with random streams of its own; results do not depend on the number of threads nor on the back end. [1]
    seed : int, optional
        Overrides the scenario's seed. [1]
    settings : Settings, optional
        Methods and risks.
    out : str or Path, optional
        Run directory to write; without it nothing is written.
    command : str
        For the run record.
    **work
        ``backend``, ``checkpoint``, ``workers`` and ``progress`` (done, all flights) of :func:`navbound.scale.map_tiles`.

    Raises
    ------
    InputError
        No such scenario or back end, or a number outside its domain.
    FormatError
        A scenario file that cannot be read, or a run directory that cannot be written.
    """
    from navbound import scenario as scenarios  # noqa: PLC0415
    from navbound.run import fly as simulated  # noqa: PLC0415
    from navbound.run.verdict.faults import fault_summaries  # noqa: PLC0415

    with directory.own(out) as folder:
        pieces = isinstance(flights, int) and flights > FLIGHTS_IN_MEMORY
        material = simulated.material(scenario, flights=flights, seed=seed, pieces=pieces, **work)
        run = judge(material, settings, command)
        faults = [] if material.scenario is None else fault_summaries(scenarios.of_record(material.scenario), run.table, run.events)
        summary = run.summary.model_copy(update={"faults": faults})
        return directory.write(replace(run, summary=summary), folder)


@checked
def analyze(
    files: str | Path | Sequence[str | Path],
    *,
    spec: str = "RNP 0.3",
    phase: str | None = None,
    levels: str | Level | Sequence[str | Level] | None = None,
    settings: Settings | None = None,
    out: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    command: str = "",
    **reading: object,
) -> Run:
    """Read recorded tracks and judge every epoch.

    Parameters
    ----------
    files : sequence of paths
        CSV, Parquet, JSON tables or RTKLIB ``.pos``, plain or gzip.
    spec, phase : str
        Navigation specification, as :func:`navbound.rnp.requirement.requirement` reads it.
    levels
        Former spelling of :func:`evaluate`; it goes with the next release.
    progress : callable, optional
        Called with (done, all) steps: read, judged, written.
    settings, out, command
        As in :func:`fly`.
    **reading
        See :func:`navbound.run.analyze.material`: ``path``, ``truth``, ``sigma_m``, ``columns``, ...

    Raises
    ------
    InputError
        An argument outside its domain.
    FormatError
        A file that cannot be read; the message names file, line, field and the text found.
    """
    if levels is not None:
        warnings.warn("analyze(levels=...) is evaluate(levels=...); the old spelling goes with the next release", DeprecationWarning, 3)
        return evaluate(files, levels=levels, out=out, progress=progress, command=command, **reading)
    with directory.own(out) as folder:
        tell = progress or _nobody
        tell(0, STEPS)
        required = requirement(spec, phase)
        material = recorded.material(files, requirement=required.words, rnp_m=required.rnp_m, **reading)  # type: ignore[arg-type]
        tell(1, STEPS)
        run = judge(material, settings, command)
        tell(2, STEPS)
        if reading.get("procedure") is not None:
            from navbound.run.procedure import with_answers  # noqa: PLC0415

            run = with_answers(run)
        written = directory.write(run, folder)
        tell(STEPS, STEPS)
        return written


def _nobody(done: int, total: int) -> None:
    """Nobody waits."""


@checked
def evaluate(
    files: str | Path | Sequence[str | Path],
    *,
    levels: str | Level | Sequence[str | Level],
    out: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    command: str = "",
    **reading: object,
) -> Run:
    """Evaluate errors and protection levels against service levels: accuracy, integrity, availability, continuity.

    Parameters
    ----------
    files : sequence of paths
        Tables with protection levels, any number, joined by time; or RINEX observations with navigation files and, where a service
        corrects them, SBAS messages.
    levels : names or Level
        Service levels (:func:`navbound.kpi.levels`).
    out, command
        As in :func:`fly`. A run that was interrupted goes on where its directory ends.
    progress : callable, optional
        Called with (done, all) files.
    **reading
        Fields of :class:`navbound.run.evaluate.performance.Options`: ``truth``, ``columns``, ``prn``, ``protection``, ``signals``, ...

    Raises
    ------
    InputError
        An argument outside its domain.
    FormatError
        A file that cannot be read; the message names file, line, field and the text found.
    """
    from navbound.run.evaluate import performance  # noqa: PLC0415

    named = [levels] if isinstance(levels, (str, Level)) else list(levels)
    options = performance.Options(levels=named, **reading)  # type: ignore[arg-type]
    return performance.evaluate_files(files, options, out=out, command=command, progress=progress)
