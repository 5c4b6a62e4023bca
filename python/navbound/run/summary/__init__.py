"""From judged epochs to summary.json: margins, missing epochs, the verdict's counts, phases and tracks, methods, consistency."""
