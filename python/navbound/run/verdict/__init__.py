"""The verdict of a run: the rule that decides it, the check of its bounds against truth, and its words (with run/verdict/results.py)."""
