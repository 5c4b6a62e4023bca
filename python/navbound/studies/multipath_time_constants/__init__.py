"""Time constants of smoothed multipath: appendix A of Song, Milner and No 2024 (navi.673)."""
