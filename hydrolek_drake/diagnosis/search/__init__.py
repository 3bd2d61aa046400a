"""The search among structures, best first."""
