"""What a table says beside the columns that are read: further columns, other places of the vehicle, a speed whose unit nobody states."""
