"""Arguments of public functions: what kind of object each may be, and arrays that are broadcast for the core and given back in shape."""
