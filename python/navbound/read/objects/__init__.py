"""Objects and structures to columns: JSON, what decoders of aircraft write, and columns of structures."""
