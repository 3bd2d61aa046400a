"""How far numbers are known."""
