"""How far numbers are known, and from which size on an effect would have been seen."""
