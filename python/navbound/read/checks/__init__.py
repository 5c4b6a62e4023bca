"""What speaks against recorded rows: motion that cannot be flown, repeats, statements of the file itself; and the count of unused rows."""
