"""Error Extraction (experimental, not integrity): the published comparison on a real day, its gain by cause, and other laws of error."""
