"""Types of the compiled module. tests/test_stubs.py compares this list with the module's exports."""

from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__version__: str

def methods() -> list[dict[str, Any]]: ...

@final
class Path:
    @staticmethod
    def line(lat0_rad: float, lon0_rad: float, lat1_rad: float, lon1_rad: float) -> Path: ...
    @staticmethod
    def from_azimuth(lat_rad: float, lon_rad: float, course_rad: float) -> Path: ...
    @staticmethod
    def route(lat_rad: NDArray[np.float64], lon_rad: NDArray[np.float64], radius_m: NDArray[np.float64]) -> Path: ...
    @property
    def length_m(self) -> float: ...
    @property
    def waypoints_along_m(self) -> list[float]: ...
    def project(
        self, lat_rad: NDArray[np.float64], lon_rad: NDArray[np.float64], near_along_m: float | None = None
    ) -> dict[str, NDArray[Any]]: ...
    def at(self, along_m: NDArray[np.float64]) -> dict[str, NDArray[Any]]: ...
