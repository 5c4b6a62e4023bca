"""Inertial navigation: simulated sensors, mechanization, and the navigation filter that aids it."""

from __future__ import annotations

from navbound.ins.aiding import Aiding, BaroHeights, DmeRanges, Fixes, SatelliteRanges, VorBearings
from navbound.ins.covariance_consistency import consistency
from navbound.ins.fusion import Fused, Innovations, Reversion, Track, coarse_attitude, fuse, mechanize
from navbound.ins.settings import Clock, FilterSettings, Imu, ImuModel, SensorNoise, Start, StartSigma, Wheels
from navbound.ins.simulation import Rolled, Sensed, roll, simulate

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
