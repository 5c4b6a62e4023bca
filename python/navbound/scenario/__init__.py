"""Scenarios: models and the shipped TOML files."""
