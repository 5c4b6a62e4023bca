"""What a recording states of the validity or the integrity of its own positions: in which columns, in which words."""
