"""Records: what the stages hand to each other and what a run leaves on the disk (run, performance, prediction, maps).

Records are immutable pydantic models. They decide nothing, and they import nothing of navbound but errors and each other.
"""
