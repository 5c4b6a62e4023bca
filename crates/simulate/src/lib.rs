//! Scenario and seed to truth and signal records.
