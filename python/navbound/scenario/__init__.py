"""Scenarios: what is flown in a simulation, how, and how well the aircraft knows where it is."""

from navbound.scenario.files import find, load, shipped
from navbound.scenario.models import Scenario

__all__ = ["Scenario", "find", "load", "shipped"]
