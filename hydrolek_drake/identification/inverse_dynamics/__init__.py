"""Parameters of a motor-driven joint from its force: linear in them, so that no search is needed."""
