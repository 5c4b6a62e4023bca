"""Recorded files to the epoch table."""
