"""Tile functions that worker processes can import; each keeps a log of its calls in a folder of the test's."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navbound.errors import InputError


def numbers(tile: int) -> dict[str, NDArray[np.generic]]:
    """Numbers whose last bits would show any difference."""
    x = np.linspace(0.1, 1.0, 50) * (tile + 1)
    return {"y": np.sin(x) / np.sqrt(x), "n": np.arange(tile, tile + 3)}


@dataclass(frozen=True)
class Logged:
    """`numbers`, with a file a call in a folder, and a pause that leaves time to interrupt."""

    folder: str
    pause_s: float = 0.0

    def __call__(self, tile: int) -> dict[str, NDArray[np.generic]]:
        (Path(self.folder) / f"{tile}-{os.getpid()}-{time.monotonic_ns()}").touch()
        time.sleep(self.pause_s)
        return numbers(tile)


@dataclass(frozen=True)
class LosesWorker:
    """`numbers`, but the first worker that meets one tile is lost; or everyone is that does."""

    folder: str
    tile: int
    always: bool = False

    def __call__(self, tile: int) -> dict[str, NDArray[np.generic]]:
        if tile == self.tile:
            mark = Path(self.folder) / "lost"
            if self.always or not mark.exists():
                mark.touch()
                os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(0.02)
        return numbers(tile)


def refuses(tile: int) -> dict[str, NDArray[np.generic]]:
    """A refusal of the third tile."""
    if tile == 2:
        raise InputError("tile", tile, "1", "[0, 2)", index=7)
    return numbers(tile)


def wrong(tile: int) -> dict[str, NDArray[np.generic]]:
    """No dictionary of arrays."""
    return {"y": [tile]}  # type: ignore[dict-item]


def evaluated(job: tuple[Callable[[Any], dict[str, NDArray[np.generic]]], Any]) -> dict[str, NDArray[np.generic]]:
    """Any function with any tile: jobs of several kinds on one set of workers."""
    function, tile = job
    return function(tile)
