"""Whether recorded positions move as the recording itself says."""
