"""Rigid links that turn on each other, and the plain arithmetic of vectors that they are told with."""
