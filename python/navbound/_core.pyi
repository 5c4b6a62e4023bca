"""Types of the compiled module. tests/test_stubs.py compares this list with the module's exports."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

__version__: str

def methods() -> list[dict[str, Any]]: ...
def bounds_of(
    method: str, risk: float, len: int, columns: dict[str, NDArray[np.float64]]
) -> tuple[NDArray[np.float64], NDArray[np.uint32], list[tuple[bool, str]]]: ...
