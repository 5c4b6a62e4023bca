"""The times by which alerts are raised and cleared where nobody states others: the monitor of a table and the live one read them here."""

from __future__ import annotations

TIME_TO_ALERT_S = 10.0
"""The most the whole chain may take: that of non-precision approach in the list of service levels, which states its source. [s]"""
RAISE_DELAY_S = 3.0
"""Waiting before a caution. Provenance: ours. [s]"""
CLEAR_DELAY_S = 10.0
"""Waiting before an alert ends. Provenance: ours. [s]"""
CLEAR_RATIO = 0.95
"""Share of the limit within which an alert ends. Provenance: ours. [1]"""
