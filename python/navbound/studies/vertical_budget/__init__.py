"""The worked example of the vertical error budget of RNP AR, term by term (FAA Order 8260.52)."""
