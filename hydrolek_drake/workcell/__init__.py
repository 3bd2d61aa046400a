"""The arms with a pipe before them: rendering, collisions, paths."""
