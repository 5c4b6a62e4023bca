"""The published comparison of methods for the total system error, entry by entry."""
