"""Decorrelation time of ground monitors: appendix B of Song, Milner and No 2024 (navi.673)."""
