"""Inertial navigation and the sensors that aid it."""

from __future__ import annotations

from navbound._ins_simulate import Sensed, simulate

__all__ = ["Sensed", "simulate"]
