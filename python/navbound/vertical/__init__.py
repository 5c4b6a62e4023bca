"""The vertical of an approach: heights by pressure, the error budget of RNP AR, the error off the path, and the altimeter's setting.

Pressure altitude is what a transponder sends, whatever setting the crew has selected; an indicated altitude adds the offset of the setting;
a geometric height is above the ellipsoid; an orthometric one above the sea is less by the undulation. Errors are true minus estimated,
heights are positive up, and the angle of a path is positive for a descent. Sources and marks: docs/methods/vertical.md.
"""

from navbound.vertical.area import AreaSetting, area_setting
from navbound.vertical.budgets import (
    CONSTANTS,
    Budget,
    Constants,
    budget,
    off_path_sigma,
    requirement,
    risk_below,
    turn_geometry,
)
from navbound.vertical.heights import (
    barometric_altitude,
    barometric_distance,
    cold_correction,
    cold_correction_doc8168,
    indicated_height,
    isa_deviation,
    setting_error,
    setting_offset,
    straight_altitude,
    true_height,
)
from navbound.vertical.setting import SettingLine, SettingTest, setting_line, setting_test
from navbound.vertical.surface import LOW_M, Surface, obstacle_surface

__all__ = [
    "CONSTANTS",
    "LOW_M",
    "AreaSetting",
    "Budget",
    "Constants",
    "SettingLine",
    "SettingTest",
    "Surface",
    "area_setting",
    "barometric_altitude",
    "barometric_distance",
    "budget",
    "cold_correction",
    "cold_correction_doc8168",
    "indicated_height",
    "isa_deviation",
    "obstacle_surface",
    "off_path_sigma",
    "requirement",
    "risk_below",
    "setting_error",
    "setting_line",
    "setting_offset",
    "setting_test",
    "straight_altitude",
    "true_height",
    "turn_geometry",
]
