"""How numbers become sentences, wherever one is printed."""
