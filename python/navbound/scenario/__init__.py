"""Scenarios: what is flown in a simulation, how, and how well the aircraft knows where it is."""

from navbound.scenario.files import KINDS, find, load, of_record, read, shipped
from navbound.scenario.models import Scenario
from navbound.scenario.taxi import Taxi

__all__ = ["KINDS", "Scenario", "Taxi", "find", "load", "of_record", "read", "shipped"]
