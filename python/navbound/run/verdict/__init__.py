"""The verdict of a run: the rule that decides it, and the check of its bounds against truth. Its words are at the edge (words.py here, run/words.py)."""
