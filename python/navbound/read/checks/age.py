"""How old a position may be, whoever says its age."""

STALE_AFTER_S = 2.0
"""Age from which a position is stale. [s] Provenance: ours."""
