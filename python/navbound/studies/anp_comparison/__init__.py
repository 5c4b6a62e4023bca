"""The published evaluation of three-dimensional ANP on fused flights."""
