"""Tables and arguments: every column once (columns), how one is declared and looked up; arguments and arrays of public functions."""
