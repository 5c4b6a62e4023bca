"""What kind of operation is flown: nobody works it out from the size of a requirement."""

from __future__ import annotations

from typing import Literal

Operation = Literal["en-route", "approach", "ground"]
"""``ground``: landing roll and taxiing, where requirements are metres and what is about flight says nothing."""
