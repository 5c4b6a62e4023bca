"""Published evaluations, one folder each: what is run, the records, and the tables of them."""
