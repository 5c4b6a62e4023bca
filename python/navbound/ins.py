"""Inertial navigation: simulated sensors, mechanization, and the navigation filter that aids it."""

from __future__ import annotations

from navbound._ins_aiding import Aiding, BaroHeights, DmeRanges, Fixes, SatelliteRanges, VorBearings
from navbound._ins_consistency import consistency
from navbound._ins_fuse import Fused, Innovations, Reversion, Track, coarse_attitude, fuse, mechanize
from navbound._ins_settings import Clock, FilterSettings, Imu, ImuModel, SensorNoise, Start, StartSigma, Wheels
from navbound._ins_simulate import Rolled, Sensed, roll, simulate

__all__ = [
    "Aiding",
    "BaroHeights",
    "Clock",
    "DmeRanges",
    "FilterSettings",
    "Fixes",
    "Fused",
    "Imu",
    "ImuModel",
    "Innovations",
    "Reversion",
    "Rolled",
    "SatelliteRanges",
    "Sensed",
    "SensorNoise",
    "Start",
    "StartSigma",
    "Track",
    "VorBearings",
    "Wheels",
    "coarse_attitude",
    "consistency",
    "fuse",
    "mechanize",
    "roll",
    "simulate",
]
