"""A flight from Kyiv to Kharkiv on DME and VOR."""
