"""What a run is made from: files by what they hold, positions solved from raw measurements, and what a recording says against itself."""
