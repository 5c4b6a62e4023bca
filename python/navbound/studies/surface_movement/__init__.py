"""GBAS/INS and RRAIM for surface movement, after Song, Milner and No 2024: cells of the grid, claims, tables and page."""
