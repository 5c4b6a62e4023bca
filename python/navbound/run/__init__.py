"""Stages joined: fly, analyze and study, and the run directory they leave."""
